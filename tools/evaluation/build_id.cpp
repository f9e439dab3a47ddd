#include "tools/evaluation/build_id.hpp"

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string_view>

namespace slalom::tools {
namespace {

constexpr std::size_t shown = 6;  // bytes of an id

/// The note of the linker among those of a segment.
std::string id_in(const char* notes, std::size_t size) {
  const auto aligned = [](std::size_t n) { return (n + 3) & ~std::size_t{3}; };
  for (std::size_t at = 0; at + sizeof(ElfW(Nhdr)) <= size;) {
    ElfW(Nhdr) head;
    std::memcpy(&head, notes + at, sizeof head);
    const std::size_t name = at + sizeof head, content = name + aligned(head.n_namesz);
    if (head.n_type == NT_GNU_BUILD_ID && head.n_namesz == 4 && std::memcmp(notes + name, "GNU", 4) == 0) {
      std::string text;
      for (std::size_t i = 0; i < std::min<std::size_t>(shown, head.n_descsz); ++i) {
        char digits[3];
        std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned char>(notes[content + i]));
        text += digits;
      }
      return text;
    }
    at = content + aligned(head.n_descsz);
  }
  return {};
}

int visit(dl_phdr_info* module, std::size_t, void* result) {
  auto& text = *static_cast<std::string*>(result);
  // The program itself has no name and comes first.
  const std::string_view name = module->dlpi_name ? module->dlpi_name : "";
  if (!text.empty() && name.find("libslalom") == std::string_view::npos) return 0;
  for (int i = 0; i < module->dlpi_phnum; ++i) {
    const auto& segment = module->dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    const std::string id =
        id_in(reinterpret_cast<const char*>(module->dlpi_addr + segment.p_vaddr), segment.p_memsz);
    if (!id.empty()) {
      text += (text.empty() ? "" : "-") + id;
      break;
    }
  }
  if (text.empty()) text = "unknown";
  return 0;
}

}  // namespace

std::string build_id() {
  std::string text;
  dl_iterate_phdr(visit, &text);
  return text;
}

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

}  // namespace slalom::tools
