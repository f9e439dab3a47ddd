# Writes INPUT as the C++ source OUTPUT that defines slalom::view::page_gzip().
file(READ ${INPUT} hex HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${OUTPUT} "#include \"view/server/page_data.hpp\"
namespace slalom::view {
namespace {
constexpr unsigned char bytes[] = {${bytes}};
}
std::string page_gzip() { return std::string(reinterpret_cast<const char*>(bytes), sizeof bytes); }
}  // namespace slalom::view
")
