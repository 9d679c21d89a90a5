# A port for vcpkg: reviewed, not built; names of ports are to be confirmed. The sources are those that this file
# lies in; a port of a registry takes an archive of a release in their place.
# hdf5_serial and other names without a CMake package are Debian's: what finds
# them elsewhere is in pinode/base/CMakeLists.txt and pinode/record/CMakeLists.txt.
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../.." ABSOLUTE)

vcpkg_check_linkage(ONLY_STATIC_LIBRARY)
vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS FEATURES
  tools PINODE_BUILD_APPS)

vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${FEATURE_OPTIONS}
    -DPINODE_BUILD_TESTS=OFF
    -DPINODE_MPI=OFF
    -DPINODE_NATIVE=OFF
    -DPINODE_PYTHON=OFF
    -DPINODE_SHARED=OFF
    -DPINODE_UNITY_LIBRARY=ON
    -DPINODE_WERROR=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/pinode)
if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(AUTO_CLEAN TOOL_NAMES
    pinode_check pinode_damage pinode_discover pinode_modes pinode_simulate
    pinode_update)
endif()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include"
  "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
