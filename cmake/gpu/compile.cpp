// slalom_gpu_compile OUT.cpp HEADER PROBLEM "ARCHITECTURES" [NVRTC options]: compiles the kernels of a
// problem for each architecture, and PTX for the last one, beside OUT.cpp, which makes them a part of a
// program. A kernel whose registers do not suffice gets twice as many; if these do not suffice either, the
// status is 1.
#include <nvrtc.h>

#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr const char* standard_headers[] = {
    "algorithm",        "array",       "bit",      "cmath",       "concepts",
    "cstddef",          "cstdint",     "cstring",  "filesystem",  "functional",
    "initializer_list", "iterator",    "limits",   "memory",      "new",
    "numbers",          "numeric",     "optional", "span",        "stdexcept",
    "string",           "string_view", "tuple",    "type_traits", "utility",
    "variant",          "vector"};

std::string read(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Throws if the innermost loops of rollouts compute in double, which is 64 times slower on many GPUs.
void refuse_doubles(const std::string& ptx, const std::string& problem) {
  std::istringstream text(ptx);
  std::vector<std::string> lines;
  std::map<std::string, std::size_t> labels;
  bool rolls_out = false;
  std::size_t begin = 0;  // behind the last loop: one that begins before it has another inside
  for (std::string line; std::getline(text, line);) {
    if (line.find(".entry") != std::string::npos) rolls_out = line.find("mppi") != std::string::npos;
    line.erase(0, line.find_first_not_of(" \t"));
    lines.push_back(line);
    if (line.starts_with("$L")) labels[line.substr(0, line.find(':'))] = lines.size();
    const std::size_t jump = line.find("bra"), target = line.find("$L");
    if (!rolls_out || jump == std::string::npos || target == std::string::npos) continue;
    const auto label = labels.find(line.substr(target, line.find(';') - target));
    if (label == labels.end() || label->second < begin) continue;
    begin = lines.size();
    for (std::size_t i = label->second; i < lines.size(); ++i)
      for (const char* operation : {"add.", "sub.", "mul.", "fma.", "div.", "rcp.", "sqrt."})
        if (lines[i].starts_with(operation) && lines[i].find(".f64") != std::string::npos)
          throw std::runtime_error(problem + ": computes in double in its rollouts: " + lines[i]);
  }
}

/// Compiles the kernels to a cubin, or PTX for a virtual architecture. `resident` as in kernels.cu.
std::string compile(const std::string& header, const std::string& problem, const std::string& architecture,
                    bool ptx, const std::vector<std::string>& more, int resident = 2) {
  std::vector<std::string> options = {
      std::string("--gpu-architecture=") + (ptx ? "compute_" : "sm_") + architecture,
      "-std=c++20",
      "-default-device",
      "-diag-suppress=1097",
      "--ptxas-options=-v",
      "-DHEADER=\"" + header + "\"",
      "-DPROBLEM=" + problem,
      "-DSLALOM_RESIDENT=" + std::to_string(resident)};
  options.insert(options.end(), more.begin(), more.end());
  std::vector<const char*> texts;
  for (const std::string& option : options) texts.push_back(option.c_str());
  const std::string source = read(SLALOM_KERNELS);
  nvrtcProgram program = nullptr;
  const std::vector<const char*> contents(std::size(standard_headers), "#include \"standard.hpp\"\n");
  nvrtcCreateProgram(&program, source.c_str(), SLALOM_KERNELS, static_cast<int>(contents.size()),
                     contents.data(), standard_headers);
  const nvrtcResult result = nvrtcCompileProgram(program, static_cast<int>(texts.size()), texts.data());
  std::size_t size = 0;
  nvrtcGetProgramLogSize(program, &size);
  std::string log(size, '\0');
  nvrtcGetProgramLog(program, log.data());
  if (result != NVRTC_SUCCESS)
    throw std::runtime_error(problem + ", architecture " + architecture + ": " + nvrtcGetErrorString(result) +
                             "\n" + log);
  std::istringstream lines(log);
  for (std::string line, kernel; std::getline(lines, line);) {
    if (line.find("properties for") != std::string::npos) kernel = line.substr(line.rfind(' ') + 1);
    const bool spills = line.find("spill") != std::string::npos &&
                        line.find(" 0 bytes spill stores, 0 bytes spill loads") == std::string::npos;
    if (spills && resident > 1) return compile(header, problem, architecture, ptx, more, 1);
    if (spills)
      throw std::runtime_error(problem + ", architecture " + architecture + ", " + kernel + ": " + line);
    if (line.find("registers") != std::string::npos)
      std::cerr << problem << ' ' << architecture << ' ' << kernel << ':' << line.substr(line.find(" Used"))
                << '\n';
  }
  (ptx ? nvrtcGetPTXSize : nvrtcGetCUBINSize)(program, &size);
  std::string code(size, '\0');
  (ptx ? nvrtcGetPTX : nvrtcGetCUBIN)(program, code.data());
  nvrtcDestroyProgram(&program);
  if (ptx) refuse_doubles(code, problem);
  return code;
}

void run(const std::vector<std::string>& a) {
  if (a.size() < 4)
    throw std::runtime_error(
        "usage: slalom_gpu_compile OUT.cpp HEADER PROBLEM \"ARCHITECTURES\" [NVRTC options]");
  const std::string &out = a[0], &header = a[1], &problem = a[2];
  const std::vector<std::string> more(a.begin() + 4, a.end());
  std::istringstream list(a[3]);
  const std::vector<std::string> architectures{std::istream_iterator<std::string>(list), {}};
  std::string symbols, table;
  for (std::size_t i = 0; i <= architectures.size(); ++i) {
    const bool ptx = i == architectures.size();
    const std::string& architecture = architectures[ptx ? i - 1 : i];
    const std::string file = out + "." + architecture + (ptx ? ".ptx" : ".cubin"),
                      name = "slalom_image_" + std::to_string(i);
    const std::string code = compile(header, problem, architecture, ptx, more);
    std::ofstream(file, std::ios::binary) << code;
    symbols += "__asm__(\".section .rodata\\n.balign 64\\n" + name + "_begin:\\n.incbin \\\"" + file +
               "\\\"\\n" + name + "_end:\\n.byte 0\\n.previous\");\nextern const unsigned char " + name +
               "_begin[], " + name + "_end[];\n";
    table += "    {" + architecture + ", " + (ptx ? "true" : "false") + ", " + name + "_begin, " + name +
             "_end},\n";
  }
  std::ofstream(out) << "#include \"" << header << "\"\n#include \"slalom/gpu/session.hpp\"\nextern \"C\" {\n"
                     << symbols << "}\nnamespace slalom::gpu {\ntemplate <>\nstd::span<const Image> images<"
                     << problem << ">() {\n  static const Image all[] = {\n"
                     << table << "  };\n  return all;\n}\n}\n";
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
