#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kerf {

/// Numbered parameters run from 1 to this (LinuxCNC's limit).
inline constexpr int kGcodeParameterMax = 5601;
/// These tell offsets (5211–5216, 5221–5386) and the current position (5420–5425) and cannot be
/// assigned.
inline constexpr int kGcodeMachineFirst = 5061;
inline constexpr int kGcodeMachineLast = 5428;

/// The #-parameters of a running program. Numbered ones are 0 until assigned; named ones do not
/// exist until assigned.
class GcodeParameters {
 public:
  /// `number` from 1 to kGcodeParameterMax.
  double numbered(int number) const { return numbered_[static_cast<std::size_t>(number)]; }
  void set(int number, double value) { numbered_[static_cast<std::size_t>(number)] = value; }
  std::optional<double> named(const std::string& name) const {
    const auto it = named_.find(name);
    return it == named_.end() ? std::nullopt : std::optional(it->second);
  }
  void set(const std::string& name, double value) { named_[name] = value; }

 private:
  std::vector<double> numbered_ = std::vector<double>(kGcodeParameterMax + 1);
  std::map<std::string, double> named_;
};

}  // namespace kerf
