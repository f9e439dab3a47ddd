// slalom_gpu_compile OUT.cpp HEADER PROBLEM "ARCHITECTURES" [NVRTC options]: compiles the kernels of a
// problem for each architecture, and PTX for the last one, beside OUT.cpp, which makes them a part of a
// program. The status is 1 if the registers of a thread do not suffice or the rollouts compute in double.
#include <nvrtc.h>

#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Strings = std::vector<std::string>;

/// Throws if the innermost loops of rollouts compute in double, which is 64 times slower on many GPUs.
void refuse_doubles(const std::string& ptx, const std::string& problem) {
  static const std::regex arithmetic(R"(\s*(add|sub|mul|fma|div|rcp|sqrt)\..*f64\s.*)"),
      jump(R"(.*\sbra(\.uni)?\s+(\$L\w+);)"), label(R"((\$L\w+):.*)");
  std::istringstream text(ptx);
  std::map<std::string, int> labels;
  bool rolls_out = false;
  std::string operation;
  int number = 0, last_double = 0, loop_end = 0;  // a loop that begins before `loop_end` has another inside
  std::smatch found;
  for (std::string line; std::getline(text, line); ++number) {
    if (line.find(".entry") != std::string::npos)
      rolls_out = line.find("slalom_samples") != std::string::npos;
    if (!rolls_out) continue;
    if (std::regex_match(line, found, label)) labels[found[1]] = number;
    if (std::regex_match(line, arithmetic)) last_double = number, operation = line;
    if (!std::regex_match(line, found, jump)) continue;
    const auto begin = labels.find(found[2]);
    if (begin == labels.end() || begin->second < loop_end) continue;
    if (last_double > begin->second)
      throw std::runtime_error(problem + ": computes in double in its rollouts: " + operation);
    loop_end = number;
  }
}

/// Compiles the kernels to a cubin, or PTX for a virtual architecture. A kernel whose registers do not
/// suffice gets twice as many: one block is `resident` on a multiprocessor in place of two.
std::string compile(const std::string& problem, const std::string& architecture, bool ptx,
                    const Strings& given, int resident = 2) {
  Strings options = given;
  options.push_back((ptx ? "--gpu-architecture=compute_" : "--gpu-architecture=sm_") + architecture);
  options.push_back("-DSLALOM_RESIDENT=" + std::to_string(resident));
  std::vector<const char*> texts;
  for (const std::string& option : options) texts.push_back(option.c_str());
  // Every standard header is standard.hpp; the header of all is those parts that a problem uses.
  static constexpr const char* headers[] = {
      "slalom/slalom.hpp", "algorithm", "array",     "bit",        "cmath",       "concepts",
      "cstddef",           "cstdint",   "cstring",   "filesystem", "functional",  "initializer_list",
      "iterator",          "limits",    "memory",    "new",        "numbers",     "numeric",
      "optional",          "span",      "stdexcept", "string",     "string_view", "tuple",
      "type_traits",       "utility",   "variant",   "vector"};
  std::vector<const char*> contents(std::size(headers), "#include \"standard.hpp\"\n");
  contents[0] =
      "#include \"slalom/core/grid_view.hpp\"\n#include \"slalom/core/network/mlp.hpp\"\n"
      "#include \"slalom/core/problem.hpp\"\n";
  nvrtcProgram program = nullptr;
  nvrtcCreateProgram(&program, "#include \"kernels.cu\"\n", "slalom", static_cast<int>(contents.size()),
                     contents.data(), headers);
  const nvrtcResult result = nvrtcCompileProgram(program, static_cast<int>(texts.size()), texts.data());
  std::size_t size = 0;
  nvrtcGetProgramLogSize(program, &size);
  std::string log(size, '\0');
  nvrtcGetProgramLog(program, log.data());
  const std::string where = problem + ", architecture " + architecture + ": ";
  if (result != NVRTC_SUCCESS) throw std::runtime_error(where + nvrtcGetErrorString(result) + "\n" + log);
  static const std::regex spills(R"(([1-9]\d* bytes spill \w+))"),
      used(R"('(\w+)' for|(Used \d+ registers))");
  std::smatch found;
  if (std::regex_search(log, found, spills)) {
    nvrtcDestroyProgram(&program);
    if (resident == 1) throw std::runtime_error(where + found[1].str());
    return compile(problem, architecture, ptx, given, 1);
  }
  for (auto i = std::sregex_iterator(log.begin(), log.end(), used); i != std::sregex_iterator(); ++i)
    std::cerr << ((*i)[1].matched ? where + (*i)[1].str() : ": " + (*i)[2].str() + "\n");
  (ptx ? nvrtcGetPTXSize : nvrtcGetCUBINSize)(program, &size);
  std::string code(size, '\0');
  (ptx ? nvrtcGetPTX : nvrtcGetCUBIN)(program, code.data());
  nvrtcDestroyProgram(&program);
  if (ptx) refuse_doubles(code, problem);
  return code;
}

void run(const Strings& a) {
  if (a.size() < 4)
    throw std::runtime_error(
        "usage: slalom_gpu_compile OUT.cpp HEADER PROBLEM \"ARCHITECTURES\" [NVRTC options]");
  const std::string &out = a[0], &header = a[1];
  const std::string problem = (a[2].starts_with("::") ? "" : "::") + a[2];  // not a name of slalom::gpu
  Strings options = {"-std=c++20",
                     "-default-device",
                     "-diag-suppress=1097",
                     "--ptxas-options=-v",
                     "-DHEADER=\"" + header + "\"",
                     "-DPROBLEM=" + problem};
  options.insert(options.end(), a.begin() + 4, a.end());
  std::istringstream list(a[3]);
  const Strings architectures{std::istream_iterator<std::string>(list), {}};
  std::string symbols, table;
  for (std::size_t i = 0; i <= architectures.size(); ++i) {
    const bool ptx = i == architectures.size();
    const std::string& architecture = architectures[ptx ? i - 1 : i];
    const std::string file = out + "." + architecture + (ptx ? ".ptx" : ".cubin"),
                      name = "slalom_image_" + std::to_string(i);
    std::ofstream(file, std::ios::binary) << compile(problem, architecture, ptx, options);
    symbols += "__asm__(\".section .rodata\\n.balign 64\\n" + name + ":\\n.incbin \\\"" + file +
               "\\\"\\n.byte 0\\n.previous\");\nextern const unsigned char " + name + "[];\n";
    table = ptx ? table + name : name + ", " + table;
  }
  std::ofstream(out) << "#include \"" << header << "\"\n#include \"slalom/gpu/session.hpp\"\nextern \"C\" {\n"
                     << symbols << "}\nnamespace slalom::gpu {\ntemplate <>\nstd::span<const Image> images<"
                     << problem << ">() {\n  static const Image all[] = {" << table
                     << "};\n  return all;\n}\n}\n";
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "slalom_gpu_compile: " << error.what() << '\n';
    return 1;
  }
}
