# The Debian package that `./run install` builds and installs.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME depthscope)
set(CPACK_PACKAGE_CONTACT "Depthscope maintainers <maintainers@depthscope.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_PACKAGE_DESCRIPTION
"Depthscope stands between an endoscope tower and the monitor of the operating
theatre. It shows the tower's picture and gives back the depth that a
monocular endoscope takes away: it tracks the scope, reconstructs the surface
of the tissue, and draws depth cues and labels that stay where they belong.
The picture never waits for any of that.

The service is enabled by hand: systemctl enable --now depthscope")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION video)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What no linker sees: the service's surroundings, and at run time the graphics driver and the font.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "systemd, udev, libegl-mesa0, libgl1-mesa-dri, fonts-dejavu-core")
set(package_files ${CMAKE_CURRENT_SOURCE_DIR}/systemd/package)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
    ${package_files}/postinst ${package_files}/prerm ${package_files}/postrm ${package_files}/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
include(CPack)
