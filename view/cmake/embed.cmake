# Writes INPUT as the C++ source OUTPUT that defines the function slalom::view::NAME() of view/embedded.hpp.
if(NAME STREQUAL page_html)  # the page lies in the tree compressed
  execute_process(COMMAND gzip -dc ${INPUT} OUTPUT_FILE ${OUTPUT}.unpacked COMMAND_ERROR_IS_FATAL ANY)
  set(INPUT ${OUTPUT}.unpacked)
endif()
file(READ ${INPUT} hex HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${OUTPUT} "#include \"view/embedded.hpp\"
namespace slalom::view {
namespace {
constexpr unsigned char bytes[] = {${bytes}};
}
std::string ${NAME}() { return std::string(reinterpret_cast<const char*>(bytes), sizeof bytes); }
}  // namespace slalom::view
")
