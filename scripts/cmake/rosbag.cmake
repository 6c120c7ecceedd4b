# mosbench_ros: librosbag_storage of Debian with what its headers include. Its own CMake and
# pkg-config files name packages that Debian does not ship with it.
set(mosbench_rosbag_includes)
foreach(header rosbag/bag.h roslz4/lz4s.h bzlib.h pluginlib/class_loader.hpp class_loader/class_loader.hpp
        rcutils/macros.h ament_index_cpp/get_package_prefix.hpp rcpputils/visibility_control.hpp)
  string(MAKE_C_IDENTIFIER "MOSBENCH_DIR_OF_${header}" directory)
  get_filename_component(package ${header} DIRECTORY)
  find_path(${directory} ${header} PATH_SUFFIXES ${package})
  mark_as_advanced(${directory})
  if(${directory})
    list(APPEND mosbench_rosbag_includes ${${directory}})
  endif()
endforeach()
add_library(mosbench_ros INTERFACE)
foreach(library rosbag_storage roslz4 bz2 rostime roscpp_serialization cpp_common
        console_bridge boost_filesystem)
  find_library(MOSBENCH_LIB_${library} ${library})
  mark_as_advanced(MOSBENCH_LIB_${library})
  if(NOT MOSBENCH_LIB_${library} OR NOT MOSBENCH_DIR_OF_rosbag_bag_h)
    message(FATAL_ERROR "ROS's bag library is not complete (${library}): install the Debian package "
            "librosbag-storage-dev, or configure with -DMOSBENCH_WITH_ROSBAG=OFF, "
            "which reads bags but writes none")
  endif()
  target_link_libraries(mosbench_ros INTERFACE ${MOSBENCH_LIB_${library}})
endforeach()
target_include_directories(mosbench_ros SYSTEM INTERFACE ${mosbench_rosbag_includes})
