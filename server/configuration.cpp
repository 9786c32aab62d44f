// SPDX-License-Identifier: Apache-2.0
#include "server/configuration.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <istream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string_view>
#include <vector>

#include "server/config_types.h"

namespace kerf {
namespace {

std::string variable_of(const std::string& option) {
  std::string variable = "KERF_";
  for (const char c : option) {
    variable += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return variable;
}

bool is_list(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

ConfigType type_of(const CLI::App& app, std::string_view key) {
  const CLI::Option* option = app.get_option_no_throw("--" + std::string(key));
  if (option == nullptr) return ConfigType::kUnknown;
  if (option->get_expected_max() == 0) return ConfigType::kBoolean;
  if (is_list(*option)) return ConfigType::kTexts;
  const std::string type = option->get_type_name();
  const bool is_number =
      type.starts_with("FLOAT") || type.starts_with("INT") || type.starts_with("UINT");
  return is_number ? ConfigType::kNumber : ConfigType::kText;
}

/// TOML whose values are checked for the type of their option before CLI11 reads them.
class TypedConfig final : public CLI::ConfigTOML {
 public:
  explicit TypedConfig(const CLI::App& app) : app_(app) {}
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    const std::string text{std::istreambuf_iterator<char>(input), std::istreambuf_iterator<char>()};
    const auto type = [this](std::string_view key) { return type_of(app_, key); };
    if (const auto fault = check_types(text, type)) {
      throw CLI::ConfigError(app_.get_config_ptr()->as<std::string>() + ":" +
                             std::to_string(fault->line) + ": " + fault->reason);
    }
    std::istringstream again(text);
    return CLI::ConfigTOML::from_config(again);
  }

 private:
  const CLI::App& app_;
};

}  // namespace

void take_environment_lists(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (!is_list(*option) || option->count() > 0) continue;
    const char* text = std::getenv(variable_of(option->get_single_name()).c_str());
    std::string_view rest = text == nullptr ? "" : text;
    constexpr std::string_view kSeparators = ", ";
    while (!rest.empty()) {
      const auto end = std::min(rest.find_first_of(kSeparators), rest.size());
      if (end > 0) option->add_result(std::string(rest.substr(0, end)));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (option->count() > 0) option->run_callback();
  }
}

void accept_configuration(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string name = option->get_single_name();
    if (name == "help" || name == "version" || is_list(*option)) continue;
    option->envname(variable_of(name));
  }
  app.config_formatter(std::make_shared<TypedConfig>(app));
  app.set_config("--config", "",
                 "TOML file of options, e.g. listen = \"0.0.0.0:8080\"; the environment may set "
                 "them too, e.g. KERF_LISTEN");
  app.allow_config_extras(CLI::config_extras_mode::error);
}

std::string config_fault(std::string reason) {
  constexpr std::string_view kUnknown = "INI was not able to parse ";
  if (!reason.starts_with(kUnknown)) return reason;
  return "there is no option '" + reason.substr(kUnknown.size()) + "'";
}

}  // namespace kerf
