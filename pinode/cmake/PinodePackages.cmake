# Debian packages by cpack: pinode, libpinode0.1, libpinode-dev, python3-pinode.
#
#   cmake --preset package && cmake --build --preset package
#   (cd build-package && cpack)
#
# tests/packages/packages_test.sh makes them, has lintian look at them, and uses
# them where nothing else is installed.

set(PINODE_PACKAGE_MAINTAINER
  "The pinode authors <nobody@pinode.invalid>" CACHE STRING
  "Who maintains the Debian packages, as Name <address>")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pinode)
set(CPACK_PACKAGE_VENDOR "The pinode authors")
# cpack would set it before that of each package.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${PINODE_PACKAGE_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_COMPONENTS_ALL)

# What dpkg wants to know of a package, and the two documents that each owes:
# pinode_debian_package(<component> <package> <section> <summary> <description>)
function(pinode_debian_package component package section summary description)
  string(TOUPPER ${component} upper)
  foreach(pair IN ITEMS
      "DEBIAN_${upper}_PACKAGE_NAME=${package}"
      "DEBIAN_${upper}_PACKAGE_SECTION=${section}"
      "DEBIAN_${upper}_DESCRIPTION=${summary}\n${description}")
    string(FIND "${pair}" "=" equals)
    string(SUBSTRING "${pair}" 0 ${equals} name)
    math(EXPR equals "${equals} + 1")
    string(SUBSTRING "${pair}" ${equals} -1 value)
    set(CPACK_${name} "${value}" PARENT_SCOPE)
  endforeach()
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
  install(FILES ${PROJECT_BINARY_DIR}/debian/copyright
    ${PROJECT_BINARY_DIR}/debian/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()

# Their text: the licence, and the news of the version.
set(debian ${PROJECT_BINARY_DIR}/debian)
# As one text: it has semicolons, at which lists of CMake end their entries.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE licence)
string(FIND "${licence}" "\n\n" title)
string(SUBSTRING "${licence}" ${title} -1 licence)
string(STRIP "${licence}" licence)
string(REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence "${licence}")
# Nothing of others is in the source; three.js comes in when it is built.
set(packed)
if(THREE_JS OR THREE_MODULE)
  set(packed "
Files: pinode/report/three_packed.cc
Copyright: 2010-2017 three.js authors
License: Expat
Comment: Of three.js, packed into the library when it is built, and by it into
 the pages that draw a structure.

License: Expat
 Permission is hereby granted, free of charge, to any person obtaining a copy of
 this software and associated documentation files (the \"Software\"), to deal in
 the Software without restriction, including without limitation the rights to
 use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies
 of the Software, and to permit persons to whom the Software is furnished to do
 so, subject to the following conditions:
 .
 The above copyright notice and this permission notice shall be included in all
 copies or substantial portions of the Software.
 .
 THE SOFTWARE IS PROVIDED \"AS IS\", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
 IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
 FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
 AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
 LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
 OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
 SOFTWARE.
")
endif()
file(CONFIGURE OUTPUT ${debian}/copyright @ONLY CONTENT
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: pinode

Files: *
Copyright: The pinode authors
License: BSD-3-clause
 @licence@
@packed@")
string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(CONFIGURE OUTPUT ${debian}/changelog @ONLY CONTENT
"pinode (@PROJECT_VERSION@) unstable; urgency=medium

  * See CHANGELOG.md of the source for what is new.

 -- @PINODE_PACKAGE_MAINTAINER@  @today@
")
execute_process(COMMAND gzip --best --no-name --keep --force
  ${debian}/changelog RESULT_VARIABLE unzipped)
if(NOT unzipped EQUAL 0)
  return()  # no Debian: no packages
endif()

# The libraries whose headers ours include, or whose names our targets carry.
file(STRINGS ${PROJECT_SOURCE_DIR}/apps/packages.txt development
  REGEX "^[a-z].*-dev$")
# The page of pinode_app and the store of pinode_watch are of programs alone.
list(REMOVE_ITEM development libcpp-httplib-dev libsqlite3-dev)
if(PINODE_MPI)
  list(APPEND development libopenmpi-dev)
endif()
list(JOIN development ", " development)
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
# Of programs and the Python package, where they are linked with it.
set(library)
set(comma)
if(PINODE_HWCAPS)
  set(library "libpinode${soversion} (= ${PROJECT_VERSION})")
  set(comma ", ")
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
endif()

if(PINODE_BUILD_APPS)
  pinode_debian_package(programs pinode science
    "structural identification from matrices and records"
"From the mass, damping and stiffness matrices of a finite-element model and
from records of sensors, pinode finds what the model misses: wrong stiffness,
damage, a nonlinear device, an unmeasured force. The equation of motion with
its named unknowns or a neural network in it is integrated and corrected until
the trajectory agrees with the record.
.
This package has the programs, which read case files.")
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "${library}")
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS gnuplot-nox)
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS libpinode-dev,python3-pinode)
  install(FILES ${PROJECT_SOURCE_DIR}/pinode/case/README.md
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pinode RENAME case_files.md
    COMPONENT programs)
  if(PINODE_WATCH)
    install(FILES ${PROJECT_SOURCE_DIR}/pinode/watch/README.md
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pinode RENAME watching.md
      COMPONENT programs)
  endif()
  install(FILES ${PROJECT_SOURCE_DIR}/pinode/matlab.md
      ${PROJECT_SOURCE_DIR}/pinode/case/recipes.md
      ${PROJECT_SOURCE_DIR}/pinode/case/security.md
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pinode COMPONENT programs)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/pinode/case/first_case
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pinode COMPONENT programs
    FILES_MATCHING PATTERN "*.md")
  set(sample three_storey.toml C_mass.csv C_stiffness.csv train.csv holdout.csv)
  list(TRANSFORM sample PREPEND ${PROJECT_SOURCE_DIR}/data/three_storey/)
  install(FILES ${sample}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pinode/examples/three_storey
    COMPONENT programs)
endif()

if(PINODE_SHARED)
  pinode_debian_package(shared libpinode${soversion} libs
    "structural identification, shared library"
"pinode identifies structures from the matrices of a finite-element model and
from records of sensors.
.
This package has the library that programs in C++ are linked with.")
  set(CPACK_DEBIAN_SHARED_PACKAGE_SHLIBDEPS ON)
  # ldconfig, and which package has the library for those linked with it.
  file(WRITE ${debian}/triggers "activate-noawait ldconfig\n")
  file(WRITE ${debian}/shlibs
    "libpinode ${soversion} libpinode${soversion} (>= ${PROJECT_VERSION})\n")
  set(CPACK_DEBIAN_SHARED_PACKAGE_CONTROL_EXTRA
    ${debian}/triggers ${debian}/shlibs)
endif()

pinode_debian_package(development libpinode-dev libdevel
  "structural identification, headers and static libraries"
"pinode identifies structures from the matrices of a finite-element model and
from records of sensors.
.
This package has what programs in C++ are built with: headers, static libraries
and files for CMake.")
if(PINODE_SHARED)
  string(APPEND development
    ", libpinode${soversion} (= ${PROJECT_VERSION})")
endif()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${development}")

if(PINODE_PYTHON)
  pinode_debian_package(python python3-pinode python
    "structural identification, package for Python"
"pinode identifies structures from the matrices of a finite-element model and
from records of sensors.
.
This package has the package pinode for Python 3, with arrays of NumPy in place
of files.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "${library}${comma}python3 (>= 3.${Python3_VERSION_MINOR}~), python3 (<< 3.${next_python}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS
    "python3-scipy, python3-matplotlib")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS
    "python3-pandas, python3-tqdm, calculix-ccx")
  file(WRITE ${debian}/postinst "#!/bin/sh
set -e
if command -v py3compile >/dev/null 2>&1; then
  py3compile -p python3-pinode
fi
")
  file(WRITE ${debian}/prerm "#!/bin/sh
set -e
if command -v py3clean >/dev/null 2>&1; then
  py3clean -p python3-pinode
fi
")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    ${debian}/postinst ${debian}/prerm)
endif()

include(CPack)
