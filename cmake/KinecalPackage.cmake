# `cpack` in a build tree makes Debian packages:
#   kinecal         the program, and nothing that only a compiler needs
#   libkinecal-dev  libraries, headers, and what you need to build against them
#   kinecal-opencv  if there is OpenCV: the plug-in for checkerboards, grids of discs, ChArUco boards and markers of ArUco
#   kinecal-robot-calibration  the programs of robot_calibration as links to kinecal, in a prefix of their own: no file is in
#                   ros-<distro>-robot-calibration, too, so both may be installed, and the shell chooses (setup.bash).  It does
#                   not provide that package, which also has messages and headers.
#   python3-kinecal  if there is pybind11: the package `kinecal` of Python
#   kinecal-mpi     if there is MPI: the plug-in for processes of mpirun
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "kinecal developers")
set(CPACK_PACKAGE_CONTACT "kinecal developers <kinecal@example.org>")
set(CPACK_PACKAGE_DESCRIPTION
"kinecal takes a URDF, a list of what may be wrong (joint zeros, frames, camera
intrinsics, depth offset and scale) and recorded samples, and gives back the
corrected URDF and camera files, with figures that say how good they are.
It reads the configurations and samples of robot_calibration and needs no ROS.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(needed_to_build  # what the headers include and kinecalConfig.cmake looks for
  "libeigen3-dev (>= 3.4), libceres-dev (>= 2.1), liburdfdom-dev, libyaml-dev, \
libpugixml-dev, libfmt-dev, zlib1g-dev, libboost-dev (>= 1.74), nlohmann-json3-dev (>= 3.11), \
libssl-dev (>= 3.0), pkg-config")
foreach(package IN LISTS KINECAL_OPTIONAL_PACKAGES)
  string(APPEND needed_to_build ", ${package}")
endforeach()
# What programs are linked with is added; the libraries of KinecalLevels.cmake are their own.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS
  ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}/kinecal)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_KINECAL_PACKAGE_NAME kinecal)
set(CPACK_DEBIAN_KINECAL_DESCRIPTION "calibration of robots with arms, heads and cameras
${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libkinecal-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "kinecal (= ${PROJECT_VERSION}), ${needed_to_build}")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "cmake (>= 3.25), g++ (>= 4:12)")
set(CPACK_DEBIAN_DEV_DESCRIPTION "libraries and headers of kinecal: calibrators of one's own
 Forward kinematics, residuals with exact derivatives, solving and judging,
 for any robot.")
set(CPACK_DEBIAN_MPI_PACKAGE_NAME kinecal-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "kinecal (= ${PROJECT_VERSION}), openmpi-bin")
set(CPACK_DEBIAN_MPI_DESCRIPTION "one calibration or study in several processes of mpirun")
set(CPACK_DEBIAN_OPENCV_PACKAGE_NAME kinecal-opencv)
set(CPACK_DEBIAN_OPENCV_PACKAGE_DEPENDS "kinecal (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_OPENCV_DESCRIPTION "checkerboards, grids of discs and ChArUco boards in photographs, by OpenCV")
set(CPACK_DEBIAN_ROBOT_CALIBRATION_PACKAGE_NAME kinecal-robot-calibration)
set(CPACK_DEBIAN_ROBOT_CALIBRATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_ROBOT_CALIBRATION_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_ROBOT_CALIBRATION_PACKAGE_DEPENDS "kinecal (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_ROBOT_CALIBRATION_DESCRIPTION "kinecal in the place of robot_calibration of ROS
 Links under the names of its programs, in a prefix of their own.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-kinecal)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "kinecal (= ${PROJECT_VERSION}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "kinecal in Python: arrays in, a verdict out
 Kinematics of any URDF, calibration with error bars and a verdict.")
include(CPack)
cpack_add_component_group(kinecal)
cpack_add_component_group(dev)
cpack_add_component_group(mpi)
cpack_add_component_group(opencv)
cpack_add_component_group(robot_calibration)
cpack_add_component_group(python)
cpack_add_component(program GROUP kinecal)
cpack_add_component(Unspecified GROUP dev)
cpack_add_component(headers GROUP dev)
cpack_add_component(plugin GROUP mpi)
cpack_add_component(opencv_plugin GROUP opencv)
cpack_add_component(robot_calibration GROUP robot_calibration)
cpack_add_component(python GROUP python)
