# The Debian package that `./run install` builds and installs.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME depthscope)
set(CPACK_PACKAGE_CONTACT "Depthscope maintainers <maintainers@depthscope.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION video)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What is loaded at run time and no linker sees: the graphics driver and the font.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libegl-mesa0, libgl1-mesa-dri, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
    ${CMAKE_CURRENT_SOURCE_DIR}/systemd/package/postinst
    ${CMAKE_CURRENT_SOURCE_DIR}/systemd/package/prerm
    ${CMAKE_CURRENT_SOURCE_DIR}/systemd/package/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
include(CPack)
