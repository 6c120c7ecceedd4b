# cmake -DFUNCTION=name -DFOLDER=folder -DSOURCE=file.cpp -P embed_folder.cmake; see embed.cmake.
file(GLOB files ${FOLDER}/*.txt)
set(rows)
foreach(file IN LISTS files)
  cmake_path(GET file STEM name)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
  string(APPEND rows "      {\"${name}\", \"${bytes}\"},\n")
endforeach()
file(WRITE ${SOURCE} "#include <string_view>
#include <utility>

namespace mosbench {

std::string_view ${FUNCTION}(std::string_view name);

std::string_view ${FUNCTION}(std::string_view name) {
  static constexpr std::pair<std::string_view, std::string_view> kFiles[] = {
${rows}  };
  for (const auto& [known, text] : kFiles) {
    if (known == name) return text;
  }
  return {};
}

}  // namespace mosbench
")
