# pinode_add_floor(<folder> SOURCES ... [TESTS ...] [PUBLIC ...] [PRIVATE ...])
#
# One static library target pinode_<folder>, exported as pinode::<folder>, and
# one test program pinode_<folder>_test of the *_test.cc files beside it.

include(GNUInstallDirs)

set(PINODE_WARNINGS -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
if(PINODE_WERROR)
  list(APPEND PINODE_WARNINGS -Werror)
endif()

# Flags of our own sources; none of them is exported.
function(pinode_private_flags target)
  target_compile_options(${target} PRIVATE ${PINODE_WARNINGS})
  if(PINODE_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
endfunction()

function(pinode_add_floor folder)
  cmake_parse_arguments(FLOOR "" "" "SOURCES;TESTS;PUBLIC;PRIVATE" ${ARGN})
  set(target pinode_${folder})
  add_library(${target} STATIC ${FLOOR_SOURCES})
  add_library(pinode::${folder} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${folder})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  # Ceres is built for plain x86-64. Whatever our own flags are, everything
  # that Eigen allocates must be aligned the same on both sides.
  target_compile_definitions(${target} PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_link_libraries(${target} PUBLIC ${FLOOR_PUBLIC} PRIVATE ${FLOOR_PRIVATE})
  pinode_private_flags(${target})
  install(TARGETS ${target} EXPORT pinodeTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  if(PINODE_BUILD_TESTS AND FLOOR_TESTS)
    add_executable(${target}_test ${FLOOR_TESTS})
    target_link_libraries(${target}_test PRIVATE
      ${target} ${FLOOR_PRIVATE} GTest::gmock GTest::gtest_main)
    pinode_private_flags(${target}_test)
    gtest_discover_tests(${target}_test TEST_PREFIX "${folder}."
      PROPERTIES LABELS ${folder} DISCOVERY_TIMEOUT 60)
  endif()
endfunction()
