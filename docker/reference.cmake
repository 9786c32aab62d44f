# SPDX-License-Identifier: Apache-2.0
# `cmake --build build/release --target reference` writes the reference of the kernel, the formats
# and libkerf_agent, from the comments of their headers, to build/release/reference/html. It needs
# doxygen, which nothing else does.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()
set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/reference)
set(DOXYGEN_FILE_PATTERNS *.h)
set(DOXYGEN_EXCLUDE_PATTERNS */examples/*)
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
set(DOXYGEN_WARN_IF_UNDOCUMENTED NO)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_QUIET YES)
doxygen_add_docs(reference kernel server/formats haptic_agent/library/kerf_agent.h)
