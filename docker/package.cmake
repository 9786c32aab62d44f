# SPDX-License-Identifier: Apache-2.0
# Debian packages of the components of install.cmake: `cpack --config build/release/CPackConfig.cmake` (docker/README.md).
set(KERF_MAINTAINER "Kerf maintainers <maintainers@kerf.example>" CACHE STRING "Maintainer of the Debian packages")

foreach(pair server:kerf agent:kerf-agent library:libkerf-agent1 dev:libkerf-dev)
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 component)
  list(GET pair 1 package)
  install(FILES LICENSE RENAME copyright DESTINATION share/doc/${package} COMPONENT ${component})
  install(FILES CHANGELOG.md DESTINATION share/doc/${package} COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME kerf)
set(CPACK_PACKAGE_VENDOR Kerf)
set(CPACK_PACKAGE_CONTACT ${KERF_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL server agent library dev)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${KERF_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)

set(CPACK_DEBIAN_SERVER_PACKAGE_NAME kerf)
set(CPACK_DEBIAN_SERVER_PACKAGE_SECTION science)
set(CPACK_DEBIAN_SERVER_PACKAGE_SUGGESTS kerf-agent)
set(CPACK_COMPONENT_SERVER_DESCRIPTION "server for carving a block together\n\
 kerf-server keeps blocks that several people carve at the same time, computes\n\
 force and torque of every cut, and serves a viewer for browsers.\n\
 kerf-carve runs NC programs (G-code, APT) against a block and writes the result.")
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/docker/debian/server/postinst
  ${PROJECT_SOURCE_DIR}/docker/debian/server/prerm)

set(CPACK_DEBIAN_AGENT_PACKAGE_NAME kerf-agent)
set(CPACK_DEBIAN_AGENT_PACKAGE_SECTION science)
set(CPACK_DEBIAN_AGENT_PACKAGE_SUGGESTS "libasound2, python3") # for --sound; for kerf-haply
set(CPACK_COMPONENT_AGENT_DESCRIPTION "haptic device agent of Kerf\n\
 kerf-agent connects a 5-DOF force-torque device to a Kerf session: it streams\n\
 the device's motion and displays the force and torque of the cut at 1 kHz.")
set(CPACK_DEBIAN_AGENT_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/docker/debian/agent/postinst)

# Named after its SONAME, so that programs keep the version that they were linked with.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libkerf-agent1)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "haptic devices in Kerf sessions, from other programs\n\
 libkerf_agent joins a session for a program that has a device of its own: poses\n\
 in, force and torque out, at 1 kHz, passive and within a safety envelope.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libkerf-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "libkerf-agent1 (= ${PROJECT_VERSION}), libexpat1-dev, libmeshoptimizer-dev, libminizip-dev, libtinygltf-dev, pkg-config")
set(CPACK_COMPONENT_DEV_DESCRIPTION "kernel, file formats and agent of Kerf, for other programs\n\
 kerf::kernel removes the sweeps of tools from dexel stock and computes cutting\n\
 force and torque; kerf::formats reads and writes scenes, G-code, APT and meshes;\n\
 kerf::agent joins a session with a haptic device.")
include(CPack)
