# What find_package(msf_slam) finds in other projects: one target over all installed rooms.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/msf_slam)

add_library(msf_slam INTERFACE)
target_link_libraries(msf_slam INTERFACE msf_system)
target_compile_features(msf_slam INTERFACE cxx_std_20)
add_library(msf_slam::msf_slam ALIAS msf_slam)
install(TARGETS msf_slam EXPORT msf_slam_targets)

install(EXPORT msf_slam_targets NAMESPACE msf_slam:: FILE msf_slam-targets.cmake DESTINATION ${package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/msf_slam-config.cmake.in
                              ${PROJECT_BINARY_DIR}/msf_slam-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/msf_slam-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/msf_slam-config.cmake ${PROJECT_BINARY_DIR}/msf_slam-config-version.cmake
        DESTINATION ${package_folder})
