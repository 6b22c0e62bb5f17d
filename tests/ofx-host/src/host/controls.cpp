// The log of the library and the messages to the user.

#include "controls.h"

#include <cstdio>
#include <iostream>
#include <streambuf>

namespace rototoon_host {

std::string text_of(rust::Str s) { return std::string(s.data(), s.size()); }

std::string status_name(OfxStatus status) { return OFX::StatStr(status); }

Controls &controls() {
  static Controls instance;
  return instance;
}

namespace {

// Records the library's output to std::cout line by line. Lines of different threads are not mixed.
class LineLog : public std::streambuf {
protected:
  int overflow(int c) override {
    if (c != EOF) put(static_cast<char>(c));
    return c;
  }
  std::streamsize xsputn(const char *s, std::streamsize n) override {
    for (std::streamsize i = 0; i < n; ++i) put(s[i]);
    return n;
  }

private:
  void put(char c) {
    static thread_local std::string line;
    if (c != '\n') {
      line += c;
      return;
    }
    std::lock_guard<std::mutex> lock(controls().mutex);
    controls().log.push_back(line);
    line.clear();
  }
};

} // namespace

void log_output() {
  static LineLog log;
  static bool first = true;
  if (first) std::cout.rdbuf(&log), first = false;
}

void say(const char *type, const char *format, va_list args) {
  va_list copy;
  va_copy(copy, args);
  int length = vsnprintf(nullptr, 0, format, copy);
  va_end(copy);
  std::vector<char> text(length + 1);
  vsnprintf(text.data(), text.size(), format, args);
  std::lock_guard<std::mutex> lock(controls().mutex);
  controls().messages.push_back(std::string(type) + ": " + text.data());
}

} // namespace rototoon_host
