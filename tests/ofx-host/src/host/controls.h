// What tests set and read: the state of the host that all threads share.
#pragma once

#include "library.h"
#include "rust/cxx.h"

#include <atomic>
#include <cstdarg>
#include <mutex>
#include <string>
#include <vector>

namespace rototoon_host {

std::string text_of(rust::Str s);
std::string status_name(OfxStatus status);

// The state that tests set and read, shared by all threads.
struct Controls {
  std::mutex mutex;
  std::vector<std::string> log, messages;
  std::vector<std::string> missing_suites;
  std::atomic<int> aborts_left{-1}, cancels_left{-1}, live_images{0};
  std::atomic<bool> no_images{false}, temporal{true}, menus{false}, null_messages{false}, viewer_draws{false};
  std::atomic<double> real_scale{1};
  std::atomic<unsigned> cpus{1};
  std::atomic<double> progress{0};
};

Controls &controls();

// Sends the library's output to the log of the controls.
void log_output();

// Records a message to the user.
void say(const char *type, const char *format, va_list args);

} // namespace rototoon_host
