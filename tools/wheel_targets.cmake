# The ROS wheels name include folders of the machine that built them; CMake refuses a target with a folder that is not
# there. After each find_package the folders that do not exist are dropped.
#
# Python speaks to Fast DDS through C alone: what the packages generate for C++ is left out, a quarter of the time.
macro(find_package)
  _find_package(${ARGV})
  get_property(wheel_targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(wheel_target IN LISTS wheel_targets)
    get_target_property(wheel_folders ${wheel_target} INTERFACE_INCLUDE_DIRECTORIES)
    if(wheel_folders)
      set(wheel_kept "")
      foreach(wheel_folder IN LISTS wheel_folders)
        if(EXISTS "${wheel_folder}" OR "${wheel_folder}" MATCHES "\\$<")
          list(APPEND wheel_kept "${wheel_folder}")
        endif()
      endforeach()
      set_target_properties(${wheel_target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${wheel_kept}")
    endif()
  endforeach()
  list(FILTER AMENT_EXTENSIONS_rosidl_generate_idl_interfaces EXCLUDE REGEX "_cpp:")
endmacro()
