#include <iostream>
#include <memory>

#include "commands.h"
#include "completion.h"

namespace fathom {

void addCompletion(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "completion", "Print a script that completes commands, options and files in your shell");
  command->footer(
      "Examples:\n"
      "  bash: eval \"$(fathom completion bash)\"      (in ~/.bashrc)\n"
      "  zsh:  source <(fathom completion zsh)        (in ~/.zshrc, after compinit)\n"
      "  fish: fathom completion fish | source        (in ~/.config/fish/config.fish)");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "The shell")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([shell, root = context.root] {
    std::cout << (*shell == "bash"  ? bashCompletion(*root)
                  : *shell == "zsh" ? zshCompletion(*root)
                                    : fishCompletion(*root));
  });
}

}  // namespace fathom
