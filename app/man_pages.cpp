#include "man_pages.h"

#include <algorithm>
#include <sstream>

#include "core/version.h"

namespace fathom {
namespace {

std::vector<const CLI::App*> commandsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::string upperCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

/// A backslash, a hyphen that is typed, a dot or quote that begins a line: roff means something else by them.
std::string roff(const std::string& text) {
  std::string result;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) result += "\\&";
    line_begins = c == '\n';
    result += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string section(const std::string& title) { return ".SH " + title + "\n"; }

/// Lines as they are.
std::string verbatim(const std::string& text) { return ".nf\n" + roff(text) + "\n.fi\n"; }

bool takesValue(const CLI::Option& option) { return option.get_items_expected_max() != 0; }

/// "-h, --help", "--out FOLDER", "RECORDING".
std::string optionTerm(const CLI::Option& option) {
  if (option.get_positional()) return italic(option.get_name(true));
  std::string term;
  for (const auto& name : option.get_snames()) term += (term.empty() ? "" : ", ") + bold("-" + name);
  for (const auto& name : option.get_lnames()) term += (term.empty() ? "" : ", ") + bold("--" + name);
  return takesValue(option) ? term + " " + italic(option.get_type_name()) : term;
}

std::string optionText(const CLI::Option& option) {
  std::string text = roff(option.get_description());
  if (option.get_required()) text += " (required)";
  if (!option.get_default_str().empty()) text += " [" + roff(option.get_default_str()) + "]";
  return text;
}

std::string options(const CLI::App& app, bool positional) {
  std::string text;
  for (const CLI::Option* option : app.get_options())
    if (option->get_positional() == positional)
      text += ".TP\n" + optionTerm(*option) + "\n" + optionText(*option) + "\n";
  return text;
}

std::string synopsis(const CLI::App& app, const std::string& words) {
  std::string text = bold(words);
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_required()) continue;
    text += " " + optionTerm(*option) + (option->get_items_expected_max() > 1 ? "..." : "");
  }
  return text + (commandsOf(app).empty() ? " [" + italic("OPTIONS") + "]" : " " + italic("COMMAND")) + "\n";
}

/// What else there is to be read, of commands above and below.
std::string seeAlso(const CLI::App& app, const std::string& parent, const std::string& name) {
  std::string text;
  const auto add = [&](const std::string& page) { text += (text.empty() ? "" : ",\n") + bold(page) + "(1)"; };
  if (!parent.empty()) add(parent);
  for (const CLI::App* command : commandsOf(app)) add(name + "-" + command->get_name());
  return text + "\n";
}

/// What stands below the options in --help: its text, and its examples, which end with an empty line.
struct Footer {
  std::string text, examples;
};

Footer splitFooter(const std::string& footer) {
  const std::string mark = "Examples:\n";
  const auto at = footer.find(mark);
  if (at == std::string::npos) return {footer, ""};
  const auto end = std::min(footer.find("\n\n", at), footer.size());
  Footer parts{footer.substr(0, at) + footer.substr(end), footer.substr(at, end - at).substr(mark.size())};
  while (parts.text.ends_with('\n')) parts.text.pop_back();
  parts.text.erase(0, parts.text.find_first_not_of('\n'));
  return parts;
}

void addPages(const CLI::App& app, const std::string& parent, const std::string& words,
              std::vector<ManPage>& pages) {
  std::string name = words;
  std::replace(name.begin(), name.end(), ' ', '-');
  const std::string what = app.get_description();
  const Footer footer = splitFooter(app.get_footer());
  std::string text =
      ".TH " + upperCase(name) + " 1 \"\" \"fathom " + std::string(programVersion()) + "\" \"fathom\"\n";
  text += section("NAME") + roff(name) + " \\- " + roff(what.substr(0, what.find('\n'))) + "\n";
  text += section("SYNOPSIS") + synopsis(app, words);
  if (const std::string arguments = options(app, true); !arguments.empty())
    text += section("ARGUMENTS") + arguments;
  text += section("OPTIONS") + options(app, false);
  if (const auto commands = commandsOf(app); !commands.empty()) {
    text += section("COMMANDS");
    for (const CLI::App* command : commands)
      text += ".TP\n" + bold(command->get_name()) + "\n" + roff(command->get_description()) + "\n";
  }
  if (!footer.text.empty()) text += section("DESCRIPTION") + verbatim(footer.text);
  if (!footer.examples.empty()) text += section("EXAMPLES") + verbatim(footer.examples);
  text += section("EXIT STATUS") +
          "0 done (whatever the verdict), 2 bad input, 1 a fault of the program, 130 interrupted.\n";
  text += section("SEE ALSO") + seeAlso(app, parent, name);
  pages.push_back({name, text});
  for (const CLI::App* command : commandsOf(app))
    addPages(*command, name, words + " " + command->get_name(), pages);
}

}  // namespace

std::vector<ManPage> manPages(const CLI::App& root) {
  std::vector<ManPage> pages;
  addPages(root, "", root.get_name(), pages);
  return pages;
}

}  // namespace fathom
