// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/solid_snapshot.h"

#include "kernel/math/hash.h"

namespace kerf {

std::uint64_t SolidSnapshot::hash() const {
  if (fields.size() == 1) return fields.front().hash();
  Hash hash;
  for (const DexelSnapshot& field : fields) hash.add(field.hash());
  return hash.value();
}

}  // namespace kerf
