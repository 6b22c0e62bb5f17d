// The history of the host: its steps of undo.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace rototoon_host {

// A change of a parameter by name: how to take it back, which says how to make it again.
struct Change;
using Turn = std::function<Change()>;
struct Change {
  std::string name;
  Turn turn;
};

struct Step {
  std::string label;
  std::vector<Change> back;
};

// The host's own history: one step for each edit block, or for each value that is set outside of one.
struct History {
  std::vector<Step> steps, undone;
  int depth = 0;
  std::string label;
  bool open = false;

  void begin(const std::string &name) {
    if (depth++ == 0) label = name, open = false;
  }
  void end() { if (depth > 0) --depth; }
  void add(const Change &back) {
    if (depth == 0 || !open) steps.push_back({depth == 0 ? "set" : label, {}});
    open = depth > 0;
    steps.back().back.push_back(back);
  }
};

History &history();

} // namespace rototoon_host
