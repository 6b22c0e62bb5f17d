// What an effect of Rust holds.
#pragma once

#include "rototoon-ofx-host/src/host.h"
#include "rototoon-ofx-host/src/bridge.rs.h"
#include "test_host.h"
#include "params.h"

#include <memory>

namespace rototoon_host {

class EffectImpl {
public:
  std::unique_ptr<TestEffect> effect;
  OfxRectI window{0, 0, 0, 0};
  std::shared_ptr<Buffer> output;
};

OfxRectI rect(const Bounds &b);

} // namespace rototoon_host
