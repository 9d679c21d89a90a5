# A port for vcpkg: reviewed, not built; names of ports are to be confirmed. The sources are those that this file
# lies in; a port of a registry takes an archive of a release in their place.
# What finds libraries without a CMake package is in pinode/base/CMakeLists.txt
# and pinode/record/CMakeLists.txt.
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../.." ABSOLUTE)

vcpkg_check_linkage(ONLY_STATIC_LIBRARY)
vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS FEATURES
  tools PINODE_BUILD_APPS)

# Drawn by it, and packed into the library: structures in reports.
vcpkg_download_distfile(THREE_ARCHIVE
  URLS https://registry.npmjs.org/three/-/three-0.111.0.tgz
  FILENAME three-0.111.0.tgz
  SHA512 01c4eac862771fbe4022eb0eb800f2d0bb0ff79f10290c26fd884004714ccdde911573cd55acb5ae549b6c6e9662feca33bd86d931cc330a9b8d07787551cc91)
vcpkg_extract_source_archive(THREE_PATH ARCHIVE "${THREE_ARCHIVE}")

vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${FEATURE_OPTIONS}
    -DPINODE_APP=OFF
    -DPINODE_BUILD_TESTS=OFF
    -DPINODE_MPI=OFF
    -DPINODE_NATIVE=OFF
    -DPINODE_PYTHON=OFF
    -DPINODE_SHARED=OFF
    -DPINODE_UNITY_LIBRARY=ON
    -DPINODE_WATCH=OFF
    -DPINODE_WERROR=OFF
    "-DTHREE_JS=${THREE_PATH}/build/three.min.js")
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/pinode)
if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(AUTO_CLEAN TOOL_NAMES
    pinode_check pinode_damage pinode_discover pinode_modes pinode_new
    pinode_simulate pinode_update)
endif()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include"
  "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(
  FILE_LIST "${SOURCE_PATH}/LICENSE" "${THREE_PATH}/LICENSE")
