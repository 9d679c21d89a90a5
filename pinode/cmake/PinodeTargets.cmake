# pinode_add_floor(<folder> [APART] SOURCES ... [TESTS ...] [SLOW_TESTS ...]
#                  [PUBLIC ...] [PRIVATE ...])
#
# One static library target pinode_<folder>, exported as pinode::<folder>, and
# one test program pinode_<folder>_test of the *_test.cc files beside it, whose
# tests carry the folder's name as their label. SLOW_TESTS become a program of
# their own, pinode_<folder>_slow_test, labelled `slow`, which the sanitizer run
# leaves out (PINODE_BUILD_SLOW_TESTS). APART: pinode::pinode does not link it.
#
# pinode_add_part(<folder> <part> SOURCES ... [PUBLIC ...] [PRIVATE ...])
#
# A static library pinode_<folder>_<part> of sources that the main job does not
# need. It links pinode_<folder>, which does not link it. Programs of the main job
# are built without it. Call this before pinode_add_floor, whose tests link the
# parts of their folder.
#
# pinode_install_package() adds the umbrella target pinode::pinode, on request
# the shared library pinode::shared of the same objects, and everything that
# find_package(pinode) needs.
#
# What is installed belongs to a component each, from which cpack makes packages
# (PinodePackages.cmake): programs, shared, development, python.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(PINODE_WARNINGS -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
if(PINODE_WERROR)
  list(APPEND PINODE_WARNINGS -Werror)
endif()

# Flags of our own sources; none of them is exported.
function(pinode_private_flags target)
  target_compile_options(${target} PRIVATE ${PINODE_WARNINGS})
  if(PINODE_ARCH)
    target_compile_options(${target} PRIVATE -march=${PINODE_ARCH})
    # GCC before 13 takes the deliberately undefined registers of its own AVX
    # headers for mistakes (GCC bug 105593). The presets `dev` and `asan`, which
    # compile for any machine, keep the two warnings.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND
       CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      target_compile_options(${target} PRIVATE
        -Wno-uninitialized -Wno-maybe-uninitialized -Wno-array-bounds)
    endif()
  endif()
endfunction()

# Sources of one folder, PINODE_UNITY_BATCH at a time or as many as the second
# argument allows: what stands in their unnamed namespaces must not clash.
function(pinode_unity_build target)
  set(batch ${PINODE_UNITY_BATCH})
  if(ARGC GREATER 1 AND batch GREATER ARGV1)
    set(batch ${ARGV1})
  endif()
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
endfunction()

# Headers that most sources share, parsed once: by pinode_base, whose flags all
# floors have. They also declare the parts of Eigen that pinode_base compiles for
# everybody (base/eigen_instances.inc), so the objects need pinode_base. Nothing
# of this is exported.
function(pinode_precompile target)
  if(target STREQUAL "pinode_base")
    target_precompile_headers(${target} PRIVATE
      ${PROJECT_SOURCE_DIR}/pinode/base/precompiled.inc)
  else()
    target_precompile_headers(${target} REUSE_FROM pinode_base)
  endif()
endfunction()

# Headers that most unit tests share, parsed once for all of them. Their flags are
# those of the tests, so the library's are parsed again.
function(pinode_precompile_test target)
  if(NOT TARGET pinode_test_headers)
    set(folder ${PROJECT_SOURCE_DIR}/tests/support)
    add_library(pinode_test_headers STATIC ${folder}/precompiled.cc)
    target_link_libraries(pinode_test_headers PRIVATE pinode_base GTest::gmock)
    target_compile_definitions(pinode_test_headers PRIVATE
      PINODE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    pinode_private_flags(pinode_test_headers)
    # As programs are compiled.
    set_target_properties(pinode_test_headers PROPERTIES
      POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(pinode_test_headers PRIVATE
      ${CMAKE_CXX_COMPILE_OPTIONS_PIE} ${PINODE_TEST_FLAGS})
    target_precompile_headers(pinode_test_headers PRIVATE
      ${folder}/precompiled.inc)
  endif()
  target_precompile_headers(${target} REUSE_FROM pinode_test_headers)
endfunction()

# Compiles what only programs link as the library's sources are. A shared
# library does not show the parts of Eigen that the precompiled headers declare.
function(pinode_program_build target)
  if(PINODE_UNITY_LIBRARY)
    pinode_unity_build(${target})
  endif()
  if(PINODE_PRECOMPILE AND NOT PINODE_HWCAPS)
    pinode_precompile(${target})
  endif()
endfunction()

# Without PINODE_UNIT_TESTS, sources that sanitizers can judge are left out, and
# the program with them if nothing is left. Those labelled `slow` and `study`
# stay.
function(pinode_add_unit_test name folder label libraries)
  set(sources ${ARGN})
  if(NOT PINODE_UNIT_TESTS AND NOT label MATCHES "^(slow|study)$")
    pinode_optimised_tests(sources ${sources})
    if(NOT sources)
      return()
    endif()
  endif()
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE
    ${libraries} GTest::gmock GTest::gtest_main)
  # Where a test finds the project's data, from whatever directory it runs in.
  target_compile_definitions(${name} PRIVATE
    PINODE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  pinode_private_flags(${name})
  if(PINODE_TEST_FLAGS)
    target_compile_options(${name} PRIVATE ${PINODE_TEST_FLAGS})
    # Of a template that both have, the linker takes what comes first: that of
    # the floors, for which these flags are not meant.
    get_property(floors GLOBAL PROPERTY PINODE_FLOORS)
    target_link_libraries(${name} PRIVATE ${floors})
    list(TRANSFORM floors REPLACE "(.+)" "$<TARGET_FILE:\\1>")
    target_link_options(${name} PRIVATE
      LINKER:--whole-archive ${floors} LINKER:--no-whole-archive)
  endif()
  if(PINODE_UNITY_TESTS)
    # Names of tests are the same more often than those of the library.
    pinode_unity_build(${name} 8)
  endif()
  if(PINODE_PRECOMPILE)
    pinode_precompile_test(${name})
  endif()
  # The long ones start first.
  set(cost 0)
  if(label STREQUAL "slow")
    set(cost 10)
  endif()
  if(PINODE_TEST_PROGRAMS)
    # The longest first: seconds of those that take most, when last measured.
    set(seconds_estimate 268)
    set(seconds_study 263)
    set(seconds_modal 235)
    set(seconds_structure 200)
    list(LENGTH sources cost)
    if(DEFINED seconds_${folder})
      set(cost ${seconds_${folder}})
    endif()
    add_test(NAME ${folder}
      COMMAND ${name} --gtest_brief=1 --gtest_filter=-*Figures.*)
    set_tests_properties(${folder} PROPERTIES
      LABELS ${label} COST ${cost} TIMEOUT 1800)
    return()
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${folder}." NO_PRETTY_VALUES
    DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${label} COST ${cost})
endfunction()

# The tests among ARGN that a sanitizer's build cannot judge: figures of methods
# over many records, which it leaves out, and counts of allocations.
function(pinode_optimised_tests result)
  set(tests)
  foreach(test IN LISTS ARGN)
    file(STRINGS ${test} found LIMIT_COUNT 1
      REGEX "^TEST(_F|_P)?\\([A-Za-z]*Figures,|allocation_testing\\.h")
    if(found)
      list(APPEND tests ${test})
    endif()
  endforeach()
  set(${result} ${tests} PARENT_SCOPE)
endfunction()

# Installs these headers of pinode/${folder}, with their paths.
function(pinode_install_headers folder)
  foreach(header IN LISTS ARGN)
    get_filename_component(room "${header}" DIRECTORY)
    install(FILES ${header}
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pinode/${folder}/${room}
      COMPONENT development)
    set_property(GLOBAL APPEND PROPERTY PINODE_PUBLIC_HEADERS
      pinode/${folder}/${header})
  endforeach()
endfunction()

# The library of a floor or of its part, pinode_${name}.
function(pinode_add_layer_library name)
  cmake_parse_arguments(LAYER "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target pinode_${name})
  add_library(${target} STATIC ${LAYER_SOURCES})
  add_library(pinode::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  # Code for this machine's AVX and the code around it (Ceres, users' programs)
  # must agree on what Eigen allocates. Lowering EIGEN_MAX_ALIGN_BYTES to 16
  # does not do it: with AVX, Eigen then still frees in its own way what SSE
  # code took from malloc. So everybody who includes our headers gets the
  # alignment of the widest registers on the heap and that of SSE in fixed-size
  # members. (tests/install_test.sh crashes if this is wrong.)
  if(PINODE_ALIGNMENT)
    target_compile_definitions(${target} PUBLIC ${PINODE_ALIGNMENT})
  endif()
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_link_libraries(${target} PUBLIC ${LAYER_PUBLIC} PRIVATE ${LAYER_PRIVATE})
  pinode_private_flags(${target})
  if(PINODE_UNITY_LIBRARY)
    pinode_unity_build(${target})
  endif()
  if(PINODE_PRECOMPILE)
    pinode_precompile(${target})
  endif()
  install(TARGETS ${target} EXPORT pinodeTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
endfunction()

function(pinode_add_part folder part)
  cmake_parse_arguments(PART "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  pinode_add_layer_library(${folder}_${part} SOURCES ${PART_SOURCES}
    PUBLIC pinode_${folder} ${PART_PUBLIC} PRIVATE ${PART_PRIVATE})
  set_property(GLOBAL APPEND PROPERTY PINODE_FLOORS pinode_${folder}_${part})
  set_property(GLOBAL APPEND PROPERTY PINODE_PARTS_${folder}
    pinode_${folder}_${part})
endfunction()

# PUBLIC_HEADERS are installed, all others are for the library itself. A public
# header includes public ones only (tests/consumer).
function(pinode_add_floor folder)
  cmake_parse_arguments(FLOOR "APART" ""
    "PUBLIC_HEADERS;SOURCES;TESTS;SLOW_TESTS;PUBLIC;PRIVATE" ${ARGN})
  set(target pinode_${folder})
  pinode_add_layer_library(${folder} SOURCES ${FLOOR_SOURCES}
    PUBLIC ${FLOOR_PUBLIC} PRIVATE ${FLOOR_PRIVATE})
  if(NOT FLOOR_APART)
    set_property(GLOBAL APPEND PROPERTY PINODE_FLOORS ${target})
  endif()
  pinode_install_headers(${folder} ${FLOOR_PUBLIC_HEADERS})
  get_property(parts GLOBAL PROPERTY PINODE_PARTS_${folder})
  set(tested "${parts};${target};${FLOOR_PRIVATE}")
  if(PINODE_BUILD_TESTS AND FLOOR_TESTS)
    # Not the bare name: `study` is the label of what is run by hand.
    pinode_add_unit_test(${target}_test ${folder} floor_${folder}
      "${tested}" ${FLOOR_TESTS})
  endif()
  if(PINODE_BUILD_TESTS AND PINODE_BUILD_SLOW_TESTS AND FLOOR_SLOW_TESTS)
    pinode_add_unit_test(${target}_slow_test ${folder} slow
      "${tested}" ${FLOOR_SLOW_TESTS})
  endif()
endfunction()

# One shared library of all floors' objects. It shows what is in namespace
# pinode and hides the rest (pinode_symbols.map): what Eigen, Ceres and the
# standard library have left in the objects is not for others to link with.
function(pinode_add_shared_library)
  get_property(floors GLOBAL PROPERTY PINODE_FLOORS)
  set(symbols ${PROJECT_SOURCE_DIR}/pinode/cmake/pinode_symbols.map)
  set(objects ${floors})
  list(TRANSFORM objects REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
  add_library(pinode_shared SHARED ${objects})
  add_library(pinode::shared ALIAS pinode_shared)
  set_target_properties(pinode_shared PROPERTIES
    EXPORT_NAME shared
    OUTPUT_NAME pinode
    LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION}
    # Before 1.0 a minor version may change the interface.
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    LINK_DEPENDS ${symbols})
  target_link_options(pinode_shared PRIVATE
    -Wl,--version-script=${symbols} -Wl,--no-undefined -Wl,--as-needed)
  # Of the floors nothing is left to link but what they link.
  target_link_libraries(pinode_shared
    PRIVATE ${floors}
    INTERFACE Eigen3::Eigen Ceres::ceres glog::glog Threads::Threads)
  target_compile_features(pinode_shared INTERFACE cxx_std_17)
  target_include_directories(pinode_shared INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  if(PINODE_ALIGNMENT)
    target_compile_definitions(pinode_shared INTERFACE ${PINODE_ALIGNMENT})
  endif()
  install(TARGETS pinode_shared EXPORT pinodeTargets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    COMPONENT shared NAMELINK_COMPONENT development)
  if(PINODE_HWCAPS)
    pinode_add_shared_library_for(x86-64-v3)
  endif()
endfunction()

# The same library for newer processors, which the dynamic linker of glibc takes
# where the processor is one (ld.so(8), glibc-hwcaps); a build of its own.
function(pinode_add_shared_library_for architecture)
  include(ExternalProject)
  set(folder glibc-hwcaps/${architecture})
  set(build ${PROJECT_BINARY_DIR}/${architecture})
  set(soname libpinode.so.${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  ExternalProject_Add(pinode_${architecture}
    SOURCE_DIR ${PROJECT_SOURCE_DIR}
    BINARY_DIR ${build}
    CMAKE_ARGS
      -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
      -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
      -DPINODE_ARCH=${architecture}
      -DPINODE_BUILD_APPS=OFF
      -DPINODE_BUILD_TESTS=OFF
      -DPINODE_MPI=OFF
      -DPINODE_PRECOMPILE=${PINODE_PRECOMPILE}
      -DPINODE_PYTHON=OFF
      -DPINODE_UNITY_BATCH=${PINODE_UNITY_BATCH}
      -DPINODE_UNITY_LIBRARY=${PINODE_UNITY_LIBRARY}
      -DPINODE_WERROR=OFF
    BUILD_COMMAND ${CMAKE_COMMAND} --build . --target pinode_shared
    INSTALL_COMMAND ${CMAKE_COMMAND} -E make_directory
      ${PROJECT_BINARY_DIR}/${folder}
    COMMAND ${CMAKE_COMMAND} -E copy ${build}/${soname}
      ${PROJECT_BINARY_DIR}/${folder}/${soname}
    # What is installed as a file cpack does not strip.
    COMMAND ${CMAKE_STRIP} --strip-unneeded
      ${PROJECT_BINARY_DIR}/${folder}/${soname}
    BUILD_ALWAYS ON
    USES_TERMINAL_BUILD ON)
  # One of the two at a time, or a small machine has no memory left.
  add_dependencies(pinode_${architecture} pinode_shared)
  install(FILES ${PROJECT_BINARY_DIR}/${folder}/${soname}
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/${folder} COMPONENT shared)
endfunction()

function(pinode_install_package)
  get_property(floors GLOBAL PROPERTY PINODE_FLOORS)
  add_library(pinode_pinode INTERFACE)
  add_library(pinode::pinode ALIAS pinode_pinode)
  set_target_properties(pinode_pinode PROPERTIES EXPORT_NAME pinode)
  target_link_libraries(pinode_pinode INTERFACE ${floors})
  install(TARGETS pinode_pinode EXPORT pinodeTargets COMPONENT development)
  if(PINODE_SHARED)
    pinode_add_shared_library()
  endif()

  install(FILES ${PROJECT_SOURCE_DIR}/pinode/pinode.h
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pinode COMPONENT development)
  # setup.py copies these into the Python package.
  get_property(headers GLOBAL PROPERTY PINODE_PUBLIC_HEADERS)
  list(JOIN headers "\n" headers)
  file(WRITE ${PROJECT_BINARY_DIR}/public_headers.txt
    "pinode/pinode.h\n${headers}\n")

  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pinode)
  install(EXPORT pinodeTargets NAMESPACE pinode:: DESTINATION ${package_dir}
    COMPONENT development)
  configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/pinode/cmake/pinodeConfig.cmake.in
    ${PROJECT_BINARY_DIR}/pinodeConfig.cmake
    INSTALL_DESTINATION ${package_dir}
    NO_SET_AND_CHECK_MACRO)
  # Before 1.0 a minor version may change the interface.
  write_basic_package_version_file(
    ${PROJECT_BINARY_DIR}/pinodeConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES
    ${PROJECT_BINARY_DIR}/pinodeConfig.cmake
    ${PROJECT_BINARY_DIR}/pinodeConfigVersion.cmake
    DESTINATION ${package_dir} COMPONENT development)
  # A Debian package has its own.
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)
endfunction()
