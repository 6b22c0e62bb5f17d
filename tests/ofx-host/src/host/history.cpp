// The one history of the host.

#include "history.h"

namespace rototoon_host {

History &history() {
  static History instance;
  return instance;
}

} // namespace rototoon_host
