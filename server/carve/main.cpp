#include "server/carve/carve.h"
#include "server/carve/carve_options.h"

int main(int argc, char** argv) {
  const auto parsed = kerf::parse_carve_options(argc, argv);
  if (const int* status = std::get_if<int>(&parsed)) return *status;
  return kerf::run_carve(std::get<kerf::CarveOptions>(parsed));
}
