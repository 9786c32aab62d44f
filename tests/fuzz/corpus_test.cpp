// SPDX-License-Identifier: Apache-2.0
// Runs the inputs of corpus/, and inputs derived from them, through every target of the fuzzer.
#include "tests/fuzz/targets.h"
#include "tests/support/test.h"

namespace kerf::fuzz::corpus_test {
namespace {

std::vector<std::string> corpus_of(std::string_view name) {
  // Some targets use files of other tests.
  const std::filesystem::path tests = std::filesystem::path(KERF_SOURCE_DIR) / "tests";
  const std::filesystem::path folder = name == "wire"      ? tests / "wire/golden"
                                       : name == "journal" ? tests / "server/store"
                                                           : tests / "fuzz/corpus" / name;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const bool fits = name != "journal" || entry.path().extension() == ".kerf";
    if (entry.is_regular_file() && fits) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<std::string> inputs;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return inputs;
}

/// Flips bits, and removes, repeats and joins parts.
std::string mutated(const std::vector<std::string>& inputs, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  std::string out = inputs[below(inputs.size())];
  for (std::size_t n = 1 + below(4); n > 0 && !out.empty(); --n) {
    const std::size_t at = below(out.size());
    switch (below(5)) {
      case 0:
        out[at] = static_cast<char>(out[at] ^ (1 << below(8)));
        break;
      case 1:
        out[at] = static_cast<char>(below(256));
        break;
      case 2:
        out.erase(at, 1 + below(16));
        break;
      case 3:
        out.insert(at, out.substr(below(out.size()), 1 + below(16)));
        break;
      default: {
        const std::string& other = inputs[below(inputs.size())];
        out = out.substr(0, at) + other.substr(below(other.size()));
      }
    }
  }
  return out;
}

TEST(FuzzCorpus, EveryTargetHandlesItsCorpusAndMutations) {
  std::mt19937_64 random(20);
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    const std::vector<std::string> inputs = corpus_of(target.name);
    ASSERT_FALSE(inputs.empty());
    const auto run = [&](const std::string& text) { target.run(std::as_bytes(std::span(text))); };
    for (const std::string& input : inputs) run(input);
    run("");
    for (int n = 0; n < 60; ++n) run(mutated(inputs, random));
  }
}

}  // namespace
}  // namespace kerf::fuzz::corpus_test
