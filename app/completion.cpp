#include "completion.h"

#include <algorithm>
#include <vector>

#include "commands.h"

namespace fathom {
namespace {

/// What may follow an option or stand as an argument.
struct Value {
  enum class Kind { kNone, kAnything, kFile, kFolder, kWords };
  Kind kind = Kind::kNone;
  std::string ending;              ///< kFile: ".rawlog"; empty: any file
  std::vector<std::string> words;  ///< kWords
};

struct OptionWords {
  std::vector<std::string> names;  ///< with dashes; empty for a positional argument
  std::string help;
  Value value;
};

/// A command and the words that lead to it: "fathom", "fathom import", "fathom import csv".
struct CommandWords {
  std::string path, help;
  std::vector<std::pair<std::string, std::string>> subcommands;  ///< name, help
  std::vector<OptionWords> options, arguments;
};

std::string firstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

Value valueOf(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return {};
  const std::string type = option.get_type_name();
  if (type == values::kFolder) return {Value::Kind::kFolder, "", {}};
  if (type.starts_with(values::kFile))
    return {Value::Kind::kFile, type.substr(std::string("FILE").size()), {}};
  const auto open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {Value::Kind::kAnything, "", {}};
  return {Value::Kind::kWords, "", CLI::detail::split(type.substr(open + 1, close - open - 1), ',')};
}

OptionWords wordsOf(const CLI::Option& option) {
  OptionWords words{{}, firstLine(option.get_description()), valueOf(option)};
  for (const auto& name : option.get_snames()) words.names.push_back("-" + name);
  for (const auto& name : option.get_lnames()) words.names.push_back("--" + name);
  return words;
}

void collect(const CLI::App& app, const std::string& path, std::vector<CommandWords>& all) {
  CommandWords command{path, firstLine(app.get_description()), {}, {}, {}};
  const auto subcommands = app.get_subcommands([](const CLI::App*) { return true; });
  for (const auto* subcommand : subcommands)
    command.subcommands.emplace_back(subcommand->get_name(), firstLine(subcommand->get_description()));
  for (const auto* option : app.get_options())
    (option->get_positional() ? command.arguments : command.options).push_back(wordsOf(*option));
  all.push_back(std::move(command));
  for (const auto* subcommand : subcommands) collect(*subcommand, path + " " + subcommand->get_name(), all);
}

std::vector<CommandWords> allCommands(const CLI::App& root) {
  std::vector<CommandWords> all;
  collect(root, root.get_name(), all);
  return all;
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  return CLI::detail::join(words, between);
}

/// In single quotes, for any shell (bash, zsh; fish where there is no backslash).
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

// ---- bash

std::string bashOffer(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kFile:
      return value.ending.empty() ? "_fathom_offer -f" : "_fathom_offer_files '*" + value.ending + "'";
    case Value::Kind::kFolder:
      return "_fathom_offer -d";
    case Value::Kind::kWords:
      return "_fathom_offer -W " + quoted(joined(value.words, " "));
    default:
      return ":";
  }
}

constexpr const char* kBashStart = R"bash(# bash completion for fathom: eval "$(fathom completion bash)"
_fathom_offer() { mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen "$@" -- "$word"); }
_fathom_offer_files() {
  compopt -o filenames 2>/dev/null
  _fathom_offer -f -X "!$1"
  _fathom_offer -d
}
_fathom() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} path=fathom i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$path ${COMP_WORDS[i]}" in
)bash";

std::string alternatives(const CommandWords& command, const OptionWords& option) {
  std::vector<std::string> patterns;
  for (const auto& name : option.names) patterns.push_back(quoted(command.path + " " + name));
  return joined(patterns, "|");
}

// ---- zsh

/// In a _arguments specification [ ] : and \ are special.
std::string zshText(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zshAction(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kFile:
      return ":file:_files" + (value.ending.empty() ? "" : " -g \"*" + value.ending + "\"");
    case Value::Kind::kFolder:
      return ":folder:_files -/";
    case Value::Kind::kWords:
      return ":word:(" + joined(value.words, " ") + ")";
    case Value::Kind::kAnything:
      return ":value: ";
    case Value::Kind::kNone:
      return "";
  }
  return "";
}

std::string functionName(std::string path) {
  std::replace(path.begin(), path.end(), ' ', '_');
  return "_" + path;
}

std::string zshFunction(const CommandWords& command) {
  std::string text = functionName(command.path) + "() {\n";
  if (!command.subcommands.empty()) {
    text += "  local -a commands\n  commands=(\n";
    for (const auto& [name, help] : command.subcommands)
      text += "    " + quoted(name + ":" + zshText(help)) + "\n";
    text += "  )\n  local state line\n";
  }
  text += "  _arguments -C";
  for (const auto& option : command.options)
    for (const auto& name : option.names)
      text += " \\\n    " + quoted(name + "[" + zshText(option.help) + "]" + zshAction(option.value));
  for (const auto& argument : command.arguments)
    text += " \\\n    " + quoted(":" + zshText(argument.help) + zshAction(argument.value).substr(5));
  if (command.subcommands.empty()) return text + "\n}\n";
  text += " \\\n    '1: :->command' '*:: :->rest'\n";
  text += "  case $state in\n    command) _describe command commands ;;\n    rest) case $line[1] in\n";
  for (const auto& [name, help] : command.subcommands)
    text += "      " + name + ") " + functionName(command.path + " " + name) + " ;;\n";
  return text + "    esac ;;\n  esac\n}\n";
}

// ---- fish

/// True exactly when the words so far lead to this command and to none below it.
std::string fishCondition(const CommandWords& command) {
  std::vector<std::string> conditions;
  const auto words = CLI::detail::split(command.path, ' ');
  for (std::size_t i = 1; i < words.size(); ++i)
    conditions.push_back("__fish_seen_subcommand_from " + words[i]);
  std::vector<std::string> below;
  for (const auto& [name, help] : command.subcommands) below.push_back(name);
  if (!below.empty()) conditions.push_back("not __fish_seen_subcommand_from " + joined(below, " "));
  return conditions.empty() ? "" : " -n " + quoted(joined(conditions, "; and "));
}

std::string fishAction(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kFile:
      return value.ending.empty() ? " -r -F"
                                  : " -r -k -a " + quoted("(__fish_complete_suffix " + value.ending + ")");
    case Value::Kind::kFolder:
      return " -x -a " + quoted("(__fish_complete_directories)");
    case Value::Kind::kWords:
      return " -x -a " + quoted(joined(value.words, " "));
    case Value::Kind::kAnything:
      return " -x";
    case Value::Kind::kNone:
      return "";
  }
  return "";
}

}  // namespace

std::string bashCompletion(const CLI::App& root) {
  const auto commands = allCommands(root);
  std::string text = kBashStart;
  for (const auto& command : commands)
    if (command.path != root.get_name())
      text += "      " + quoted(command.path) + ") path=" + quoted(command.path) + " ;;\n";
  text += "    esac\n  done\n  case \"$path $before\" in\n";
  for (const auto& command : commands)
    for (const auto& option : command.options)
      if (option.value.kind != Value::Kind::kNone)
        text += "    " + alternatives(command, option) + ") " + bashOffer(option.value) + "; return ;;\n";
  text += "  esac\n  case $path in\n";
  for (const auto& command : commands) {
    std::vector<std::string> words, offers;
    for (const auto& [name, help] : command.subcommands) words.push_back(name);
    for (const auto& option : command.options)
      words.insert(words.end(), option.names.begin(), option.names.end());
    text += "    " + quoted(command.path) + ")\n      _fathom_offer -W " + quoted(joined(words, " ")) + "\n";
    for (const auto& argument : command.arguments) text += "      " + bashOffer(argument.value) + "\n";
    text += "      ;;\n";
  }
  return text + "  esac\n}\ncomplete -F _fathom fathom\n";
}

std::string zshCompletion(const CLI::App& root) {
  std::string text = "#compdef fathom\n# zsh completion for fathom: source <(fathom completion zsh)\n";
  for (const auto& command : allCommands(root)) text += zshFunction(command);
  return text + "compdef _fathom fathom\n";
}

std::string fishCompletion(const CLI::App& root) {
  std::string text = "# fish completion for fathom: fathom completion fish | source\ncomplete -c fathom -f\n";
  for (const auto& command : allCommands(root)) {
    const std::string start = "complete -c fathom" + fishCondition(command);
    for (const auto& [name, help] : command.subcommands)
      text.append(start).append(" -a ").append(name).append(" -d ").append(quoted(help)).append("\n");
    for (const auto& option : command.options) {
      text += start;
      for (const auto& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      text += fishAction(option.value) + " -d " + quoted(option.help) + "\n";
    }
    for (const auto& argument : command.arguments)
      if (const auto action = fishAction(argument.value); !action.empty()) text += start + action + "\n";
  }
  return text;
}

}  // namespace fathom
