#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "slalom/core/error.hpp"
#include "tools/command_line/description.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live_view/view_setup.hpp"

namespace slalom::tools {

void declare_completion(Subcommand& command) {
  command.summary("Print the completion of commands, options and values for a shell");
  const auto shell = std::make_shared<std::string>();
  command.option("shell", *shell, "bash or zsh").required();
  command.footer(
      "bash: slalom completion bash > ~/.local/share/bash-completion/completions/slalom\n"
      "zsh:  slalom completion zsh > FOLDER/_slalom, with a FOLDER of $fpath");
  command.action([shell] {
    const view::Choices known = choices();
    std::cout << completion_script(
        *shell, describe_commands(all_commands()),
        {.courses = known.courses, .configurations = known.configurations, .methods = known.methods});
    return 0;
  });
}

void declare_manual(Subcommand& command) {
  command.summary("Write the man pages of the program and of its commands");
  const auto folder = std::make_shared<std::string>();
  command.option("folder", *folder, "Folder of the pages; it is made if it does not exist").required();
  command.footer("Then: man FOLDER/slalom-drive.1");
  command.action([folder] {
    std::filesystem::create_directories(*folder);
    for (const ManualPage& page : manual_pages(describe_commands(all_commands()))) {
      const std::string file = (std::filesystem::path(*folder) / page.file).string();
      std::ofstream stream(file, std::ios::binary);
      stream << page.text;
      stream.close();
      if (!stream) throw IoError(file, 0, "cannot be written");
      std::printf("%s\n", file.c_str());
    }
    return 0;
  });
}

}  // namespace slalom::tools
