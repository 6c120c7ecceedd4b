# cmake -DFUNCTION=name -DFILE=file -DSOURCE=file.cpp -P embed_file.cmake; see embed.cmake.
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
file(WRITE ${SOURCE} "#include <string_view>

namespace mosbench {

std::string_view ${FUNCTION}();

std::string_view ${FUNCTION}() {
  static constexpr char kBytes[] = \"${bytes}\";
  return {kBytes, sizeof(kBytes) - 1};
}

}  // namespace mosbench
")
