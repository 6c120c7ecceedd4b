# mosbench_embed(TARGET FUNCTION FILE) adds `std::string_view mosbench::FUNCTION()` to TARGET, which
# returns the bytes of FILE as they were when the program was built. The compiler has no #embed yet.
function(mosbench_embed target function file)
  cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${function}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DFUNCTION=${function} -DFILE=${file} -DSOURCE=${source}
            -P ${PROJECT_SOURCE_DIR}/scripts/cmake/embed_file.cmake
    DEPENDS ${file} ${PROJECT_SOURCE_DIR}/scripts/cmake/embed_file.cmake
    VERBATIM)
  target_sources(${target} PRIVATE ${source})
  set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# mosbench_embed_folder(TARGET FUNCTION FOLDER) adds `std::string_view mosbench::FUNCTION(name)`, which returns the text
# of FOLDER/name.txt, empty where there is none.
function(mosbench_embed_folder target function folder)
  file(GLOB files CONFIGURE_DEPENDS ${folder}/*.txt)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${function}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DFUNCTION=${function} -DFOLDER=${folder} -DSOURCE=${source}
            -P ${PROJECT_SOURCE_DIR}/scripts/cmake/embed_folder.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/scripts/cmake/embed_folder.cmake
    VERBATIM)
  target_sources(${target} PRIVATE ${source})
  set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
