# The library slalom_bridge: the one part of the adapters that is C++20. Needs the package slalom.
add_library(slalom_bridge STATIC ${CMAKE_CURRENT_LIST_DIR}/follower/follower_plan.cpp
  ${CMAKE_CURRENT_LIST_DIR}/follower/follower_settings.cpp ${CMAKE_CURRENT_LIST_DIR}/follower/path_follower.cpp
  ${CMAKE_CURRENT_LIST_DIR}/lap_count.cpp ${CMAKE_CURRENT_LIST_DIR}/localiser.cpp
  ${CMAKE_CURRENT_LIST_DIR}/localiser_core.cpp ${CMAKE_CURRENT_LIST_DIR}/planner.cpp
  ${CMAKE_CURRENT_LIST_DIR}/planner_core.cpp ${CMAKE_CURRENT_LIST_DIR}/world.cpp ${CMAKE_CURRENT_LIST_DIR}/world_core.cpp)
target_compile_features(slalom_bridge PRIVATE cxx_std_20)
target_link_libraries(slalom_bridge PRIVATE slalom::slalom)
target_include_directories(slalom_bridge PUBLIC ${CMAKE_CURRENT_LIST_DIR}/..)
target_compile_options(slalom_bridge PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wno-psabi)
set_target_properties(slalom_bridge PROPERTIES POSITION_INDEPENDENT_CODE ON)
slalom_harden(slalom_bridge)
get_filename_component(slalom_prefix ${slalom_DIR}/../../.. ABSOLUTE)
target_compile_definitions(slalom_bridge PRIVATE SLALOM_BRIDGE_PREFIX="${slalom_prefix}")
