# All are packages of Debian 12 (apt.txt). Heavy ones stand behind one .cpp of the room that links them.
find_package(PkgConfig REQUIRED)
find_package(fmt REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(tl-expected REQUIRED)
find_package(Threads REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(GDAL REQUIRED)
find_package(embree 3 REQUIRED)
find_package(assimp REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(BZip2 REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Snappy REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Boost 1.74 REQUIRED) # headers only: Asio, Beast
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(GEOGRAPHIC REQUIRED IMPORTED_TARGET geographiclib)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)
pkg_check_modules(CRYPTO REQUIRED IMPORTED_TARGET libcrypto) # SHA-256 of signed MAVLink frames
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)

# Voxels as .vdb files, where OpenVDB is there. (Its own module asks for far more than a writer needs.) Not in sanitized builds:
# TBB's headers cast what UBSan will not have cast.
set(ISOBATH_OPENVDB AUTO CACHE STRING "Write voxels for OpenVDB: AUTO (where it is installed), ON or OFF")
if(NOT ISOBATH_OPENVDB STREQUAL OFF AND NOT ISOBATH_SANITIZE AND NOT TARGET OpenVDB::openvdb)
  find_path(ISOBATH_OPENVDB_HEADERS openvdb/openvdb.h)
  find_library(ISOBATH_OPENVDB_LIBRARY openvdb)
  find_package(TBB CONFIG QUIET)
  find_package(Imath CONFIG QUIET)
  if(ISOBATH_OPENVDB_HEADERS AND ISOBATH_OPENVDB_LIBRARY AND TBB_FOUND AND Imath_FOUND)
    add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
    set_target_properties(OpenVDB::openvdb PROPERTIES IMPORTED_LOCATION ${ISOBATH_OPENVDB_LIBRARY}
                          INTERFACE_LINK_LIBRARIES "TBB::tbb;Imath::Imath")
  elseif(ISOBATH_OPENVDB STREQUAL ON)
    message(FATAL_ERROR "ISOBATH_OPENVDB is ON, but OpenVDB, TBB or Imath is not found (Debian: libopenvdb-dev)")
  endif()
endif()

# OpenCV calibrates cameras (isobath stereo --calibrate) and is measured beside our matcher. Its own module comes with all of OpenCV.
find_path(ISOBATH_OPENCV_HEADERS opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
find_library(ISOBATH_OPENCV_CORE opencv_core)
find_library(ISOBATH_OPENCV_IMGPROC opencv_imgproc)
find_library(ISOBATH_OPENCV_CALIB3D opencv_calib3d)
if(ISOBATH_OPENCV_HEADERS AND ISOBATH_OPENCV_CORE AND ISOBATH_OPENCV_IMGPROC AND ISOBATH_OPENCV_CALIB3D AND NOT TARGET isobath_opencv)
  add_library(isobath_opencv INTERFACE IMPORTED)
  set_target_properties(isobath_opencv PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${ISOBATH_OPENCV_HEADERS}
                        INTERFACE_LINK_LIBRARIES "${ISOBATH_OPENCV_CALIB3D};${ISOBATH_OPENCV_IMGPROC};${ISOBATH_OPENCV_CORE}")
endif()
