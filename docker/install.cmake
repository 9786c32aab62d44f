# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` installs, in four components that become the Debian packages (package.cmake):
#   server  kerf-server, kerf-carve, kerf-demo, the web page, the systemd unit
#   agent   kerf-agent, kerf-haply, their udev rules
#   library libkerf_agent.so
#   dev     libraries, public headers, CMake and pkg-config files, examples
include(CMakePackageConfigHelpers)

install(TARGETS kerf-server kerf-carve kerf-demo RUNTIME COMPONENT server)
install(TARGETS kerf-agent RUNTIME COMPONENT agent)
install(DIRECTORY web/dist/ DESTINATION ${CMAKE_INSTALL_DATADIR}/kerf/web COMPONENT server OPTIONAL)
install(FILES docker/grafana.json DESTINATION ${CMAKE_INSTALL_DATADIR}/kerf COMPONENT server)
install(FILES server/formats/scene.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/kerf COMPONENT server)
install(FILES haptic_agent/demo/demo.json DESTINATION ${CMAKE_INSTALL_DATADIR}/kerf/demo COMPONENT server)
install(PROGRAMS haptic_agent/haply/kerf_haply.py RENAME kerf-haply DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT agent)
install(FILES haptic_agent/70-kerf.rules DESTINATION lib/udev/rules.d COMPONENT agent)

# The unit file contains the program's path, which is known only at installation, because CPack
# changes the prefix.
install(CODE "
  set(KERF_SERVER_PROGRAM \${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/kerf-server)
  configure_file(${PROJECT_SOURCE_DIR}/docker/kerf-server.service.in ${PROJECT_BINARY_DIR}/kerf-server.service @ONLY)
  " COMPONENT server)
install(FILES ${PROJECT_BINARY_DIR}/kerf-server.service DESTINATION lib/systemd/system COMPONENT server)

# Generate man pages and shell completions from each program's --help during installation.
function(kerf_install_help program component)
  set(out ${PROJECT_BINARY_DIR}/help/${program})
  install(CODE "
    execute_process(COMMAND ${PROJECT_SOURCE_DIR}/docker/help_pages.sh $<TARGET_FILE:${program}> ${PROJECT_VERSION} ${out}
      COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES ${out}/${program}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${out}/${program}.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME ${program} COMPONENT ${component})
  install(FILES ${out}/${program}.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    COMPONENT ${component})
  install(FILES ${out}/_${program} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT ${component})
endfunction()
kerf_install_help(kerf-server server)
kerf_install_help(kerf-carve server)
kerf_install_help(kerf-demo server)
kerf_install_help(kerf-agent agent)

# The libraries. kerf::kernel only needs the standard library; kerf::formats needs the packages that
# kerfConfig.cmake.in finds.
set_target_properties(kerf_kernel PROPERTIES EXPORT_NAME kernel)
set_target_properties(kerf_formats PROPERTIES EXPORT_NAME formats)
set_target_properties(kerf_agent PROPERTIES EXPORT_NAME agent)
install(TARGETS kerf_options kerf_kernel EXPORT kerf-kernel ARCHIVE COMPONENT dev)
install(TARGETS kerf_formats EXPORT kerf-formats ARCHIVE COMPONENT dev)
set(kerf_cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)
install(EXPORT kerf-kernel NAMESPACE kerf:: DESTINATION ${kerf_cmake_folder} COMPONENT dev)
install(EXPORT kerf-formats NAMESPACE kerf:: DESTINATION ${kerf_cmake_folder} COMPONENT dev)
configure_package_config_file(docker/kerfConfig.cmake.in kerfConfig.cmake INSTALL_DESTINATION ${kerf_cmake_folder})
write_basic_package_version_file(kerfConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kerfConfig.cmake ${PROJECT_BINARY_DIR}/kerfConfigVersion.cmake
  DESTINATION ${kerf_cmake_folder} COMPONENT dev)
install(TARGETS kerf_agent EXPORT kerf-agent LIBRARY COMPONENT library NAMELINK_COMPONENT dev)
install(EXPORT kerf-agent NAMESPACE kerf:: DESTINATION ${kerf_cmake_folder} COMPONENT dev)
install(FILES haptic_agent/library/kerf_agent.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kerf COMPONENT dev)
foreach(library kernel formats agent)
  configure_file(docker/kerf-${library}.pc.in kerf-${library}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/kerf-${library}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()

# Public headers and the headers that they include. They are copied with include paths changed to
# the installed ones.
set(kerf_public_headers
  kernel/sculpture.h kernel/kernel_version.h kernel/dexel/dexel_snapshot.h kernel/dexel/mesh_stock.h
  kernel/surface/tile_mesh.h
  kernel/tool/tool_shape.h
  server/formats/accuracy_choice.h server/formats/apt/reader.h server/formats/forces_csv.h
  server/formats/gcode/reader.h server/formats/gcode/parameter_file.h server/formats/gcode/tool_table.h
  server/formats/machine_kinematics.h server/formats/model/mesh_distance.h server/formats/model/mesh_reader.h
  server/formats/model/mesh_source.h server/formats/model/model_writer.h server/formats/model/simplify_mesh.h
  server/formats/model/stl_reader.h server/formats/motion_sink.h server/formats/pose_grid.h server/formats/program.h
  server/formats/program_error.h server/formats/program_writer.h server/formats/scene.h server/formats/units.h)
set(pending ${kerf_public_headers})
set(done "")
file(REMOVE_RECURSE ${PROJECT_BINARY_DIR}/public)
while(pending)
  list(POP_FRONT pending header)
  if(header IN_LIST done)
    continue()
  endif()
  list(APPEND done ${header})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
  file(STRINGS ${header} includes REGEX "^#include \"")
  list(TRANSFORM includes REPLACE "^#include \"([^\"]+)\".*" "\\1")
  list(APPEND pending ${includes})
  file(READ ${header} text)
  string(REGEX REPLACE "#include \"kernel/([^\"]+)\"" "#include <kerf/kernel/\\1>" text "${text}")
  string(REGEX REPLACE "#include \"server/formats/([^\"]+)\"" "#include <kerf/formats/\\1>" text "${text}")
  string(REGEX REPLACE "^server/" "" installed ${header})
  file(WRITE ${PROJECT_BINARY_DIR}/public/kerf/${installed} "${text}")
endwhile()
install(DIRECTORY ${PROJECT_BINARY_DIR}/public/kerf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/include/kerf/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kerf COMPONENT dev)
install(DIRECTORY kernel/examples DESTINATION share/doc/libkerf-dev COMPONENT dev)
install(DIRECTORY haptic_agent/examples/ DESTINATION share/doc/libkerf-dev/agent_examples COMPONENT dev
  PATTERN .clang-tidy EXCLUDE PATTERN custom_device.cpp EXCLUDE)
