#include "rototoon-ofx-host/src/host.h"
#include "rototoon-ofx-host/src/bridge.rs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <deque>
#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <sstream>
#include <streambuf>
#include <thread>
#include <vector>

#include "ofxCore.h"
#include "ofxImageEffect.h"
#include "ofxPixels.h"
#include "ofxDrawSuite.h"
#include "ofxInteract.h"
#include "ofxKeySyms.h"
#include "ofxhBinary.h"
#include "ofxhPropertySuite.h"
#include "ofxhClip.h"
#include "ofxhParam.h"
#include "ofxhMemory.h"
#include "ofxhImageEffect.h"
#include "ofxhPluginAPICache.h"
#include "ofxhPluginCache.h"
#include "ofxhHost.h"
#include "ofxhImageEffectAPI.h"
#include "ofxhUtilities.h"

// ---------------------------------------------------------------- recorded lines

namespace {
// The numbers of each line: whether it is closed, the number of its points, and their coordinates.
std::vector<double> &drawn_lines() {
  static std::vector<double> lines;
  return lines;
}
std::vector<float> &line_colours() {
  static std::vector<float> colours;
  return colours;
}
std::vector<std::string> &drawn_texts() {
  static std::vector<std::string> texts;
  return texts;
}
float current_colour[4] = {1, 1, 1, 1};
float current_width = 1;
void begin_line() {
  line_colours().insert(line_colours().end(), current_colour, current_colour + 4);
  line_colours().push_back(current_width);
}
size_t gl_line = 0;
// Whether each pair of points is a line of its own, and the number of points since the beginning.
bool gl_pairs = false;
size_t gl_points = 0;
void gl_new_line(bool closed) {
  begin_line();
  gl_line = drawn_lines().size();
  drawn_lines().push_back(closed);
  drawn_lines().push_back(0);
}
} // namespace

extern "C" {
void glBegin(unsigned mode) {
  gl_pairs = mode == 1, gl_points = 0;
  if (!gl_pairs) gl_new_line(mode == 2);
}
void glEnd() {}
void glVertex2d(double x, double y) {
  if (gl_pairs && gl_points++ % 2 == 0) gl_new_line(false);
  drawn_lines()[gl_line + 1] += 1;
  drawn_lines().push_back(x);
  drawn_lines().push_back(y);
}
void glColor4f(float r, float g, float b, float a) {
  current_colour[0] = r, current_colour[1] = g, current_colour[2] = b, current_colour[3] = a;
}
void glLineWidth(float width) { current_width = width; }
void glPushAttrib(unsigned) {}
void glPopAttrib() {}
}

namespace rototoon_host {

namespace ofx = OFX::Host;
namespace fx = OFX::Host::ImageEffect;

namespace {

const unsigned char kCanary = 0xCD;
const size_t kGuard = 4096;

std::string text_of(rust::Str s) { return std::string(s.data(), s.size()); }

std::string status_name(OfxStatus status) { return OFX::StatStr(status); }

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

Controls &controls() {
  static Controls instance;
  return instance;
}

bool changes_menus() { return controls().menus; }

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

// ---------------------------------------------------------------- undo

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

History &history() {
  static History instance;
  return instance;
}

// ---------------------------------------------------------------- values and keys of parameters

struct Track {
  std::vector<double> value;
  std::map<double, std::vector<double>> keys;

  std::vector<double> at(double time) const {
    if (keys.empty()) return value;
    auto after = keys.lower_bound(time);
    if (after == keys.end()) return keys.rbegin()->second;
    if (after == keys.begin() || after->first == time) return after->second;
    auto before = std::prev(after);
    double share = (time - before->first) / (after->first - before->first);
    std::vector<double> mixed;
    for (size_t i = 0; i < before->second.size(); ++i)
      mixed.push_back(before->second[i] + share * (after->second[i] - before->second[i]));
    return mixed;
  }
};

class Numbers {
public:
  virtual ~Numbers() {}
  virtual void remember() = 0;
  Track track;
};

template <class Base> class Keyed : public Base, public Numbers {
public:
  Keyed(ofx::Param::Descriptor &descriptor, ofx::Param::SetInstance *set) : Base(descriptor, set) {}
  OfxStatus getNumKeys(unsigned int &n) const override {
    n = static_cast<unsigned>(track.keys.size());
    return kOfxStatOK;
  }
  OfxStatus getKeyTime(int nth, OfxTime &time) const override {
    if (nth < 0 || size_t(nth) >= track.keys.size()) return kOfxStatErrBadIndex;
    time = std::next(track.keys.begin(), nth)->first;
    return kOfxStatOK;
  }
  OfxStatus deleteKey(OfxTime time) override {
    if (track.keys.count(time) == 0) return kOfxStatErrBadIndex;
    remember();
    if (track.keys.size() == 1) track.value = track.keys.begin()->second;
    track.keys.erase(time);
    return kOfxStatOK;
  }
  OfxStatus deleteAllKeys() override {
    remember();
    // As in real hosts, the parameter keeps the value that it had.
    if (!track.keys.empty()) track.value = track.keys.begin()->second;
    track.keys.clear();
    return kOfxStatOK;
  }

  void remember() override {
    if (!this->getCanUndo()) return;
    Track before = track;
    history().add(change(before));
  }

protected:
  Change change(const Track &before) {
    return {this->getName(), [this, before] {
              Track now = track;
              track = before;
              return change(now);
            }};
  }
  OfxStatus put(std::vector<double> value) {
    remember();
    track.value = value;
    return kOfxStatOK;
  }
  OfxStatus put(OfxTime t, std::vector<double> value) {
    remember();
    track.keys[t] = value;
    return kOfxStatOK;
  }
};

// A parameter of whole numbers: an integer, a choice or a flag.
template <class Base, class Value> class WholeParam : public Keyed<Base> {
public:
  WholeParam(ofx::Param::Descriptor &d, ofx::Param::SetInstance *s) : Keyed<Base>(d, s) {
    this->track.value = {double(d.getProperties().getIntProperty(kOfxParamPropDefault))};
  }
  OfxStatus get(Value &v) override { return get(0, v); }
  OfxStatus get(OfxTime t, Value &v) override { v = Value(std::lround(this->track.at(t)[0])); return kOfxStatOK; }
  OfxStatus set(Value v) override { return this->put({double(v)}); }
  OfxStatus set(OfxTime t, Value v) override { return this->put(t, {double(v)}); }
};

using IntegerParam = WholeParam<ofx::Param::IntegerInstance, int>;

// As in Natron, options are taken away all at once and added one by one at the end, and there is no value without an option.
class ChoiceParam : public WholeParam<ofx::Param::ChoiceInstance, int> {
public:
  using WholeParam::WholeParam;
  using WholeParam::set;
  void setOption(int index) override {
    int count = getProperties().getDimension(kOfxParamPropChoiceOption);
    bool allowed = changes_menus() && (count == 0 || index == count - 1);
    if (!allowed) std::cout << "options of a choice: kOfxStatErrUnsupported" << std::endl;
  }
  OfxStatus set(int v) override {
    if (v < 0 || v >= getProperties().getDimension(kOfxParamPropChoiceOption)) return kOfxStatErrBadIndex;
    return put({double(v)});
  }
};

using BooleanParam = WholeParam<ofx::Param::BooleanInstance, bool>;

class DoubleParam : public Keyed<ofx::Param::DoubleInstance> {
public:
  DoubleParam(ofx::Param::Descriptor &d, ofx::Param::SetInstance *s) : Keyed(d, s) {
    track.value = {d.getProperties().getDoubleProperty(kOfxParamPropDefault)};
  }
  OfxStatus get(double &v) override { return get(0, v); }
  OfxStatus get(OfxTime t, double &v) override { v = track.at(t)[0]; return kOfxStatOK; }
  OfxStatus set(double v) override { return put({v}); }
  OfxStatus set(OfxTime t, double v) override { return put(t, {v}); }
  OfxStatus derive(OfxTime, double &) override { return kOfxStatErrMissingHostFeature; }
  OfxStatus integrate(OfxTime, OfxTime, double &) override { return kOfxStatErrMissingHostFeature; }
};

class PairParam : public Keyed<ofx::Param::Double2DInstance> {
public:
  PairParam(ofx::Param::Descriptor &d, ofx::Param::SetInstance *s) : Keyed(d, s) {
    for (int i = 0; i < 2; ++i) track.value.push_back(d.getProperties().getDoubleProperty(kOfxParamPropDefault, i));
  }
  OfxStatus get(double &x, double &y) override { return get(0, x, y); }
  OfxStatus get(OfxTime t, double &x, double &y) override {
    std::vector<double> v = track.at(t);
    x = v[0], y = v[1];
    return kOfxStatOK;
  }
  OfxStatus set(double x, double y) override { return put({x, y}); }
  OfxStatus set(OfxTime t, double x, double y) override { return put(t, {x, y}); }
};

class ColourParam : public Keyed<ofx::Param::RGBAInstance> {
public:
  ColourParam(ofx::Param::Descriptor &d, ofx::Param::SetInstance *s) : Keyed(d, s) {
    for (int i = 0; i < 4; ++i) track.value.push_back(d.getProperties().getDoubleProperty(kOfxParamPropDefault, i));
  }
  OfxStatus get(double &r, double &g, double &b, double &a) override { return get(0, r, g, b, a); }
  OfxStatus get(OfxTime t, double &r, double &g, double &b, double &a) override {
    std::vector<double> v = track.at(t);
    r = v[0], g = v[1], b = v[2], a = v[3];
    return kOfxStatOK;
  }
  OfxStatus set(double r, double g, double b, double a) override { track.value = {r, g, b, a}; return kOfxStatOK; }
  OfxStatus set(OfxTime t, double r, double g, double b, double a) override {
    track.keys[t] = {r, g, b, a};
    return kOfxStatOK;
  }
};

// A colour without opacity.
class ShadeParam : public Keyed<ofx::Param::RGBInstance> {
public:
  ShadeParam(ofx::Param::Descriptor &d, ofx::Param::SetInstance *s) : Keyed(d, s) {
    for (int i = 0; i < 3; ++i) track.value.push_back(d.getProperties().getDoubleProperty(kOfxParamPropDefault, i));
  }
  OfxStatus get(double &r, double &g, double &b) override { return get(0, r, g, b); }
  OfxStatus get(OfxTime t, double &r, double &g, double &b) override {
    std::vector<double> v = track.at(t);
    r = v[0], g = v[1], b = v[2];
    return kOfxStatOK;
  }
  OfxStatus set(double r, double g, double b) override { return put({r, g, b}); }
  OfxStatus set(OfxTime t, double r, double g, double b) override { return put(t, {r, g, b}); }
};

class TextParam : public ofx::Param::StringInstance {
  Change change(const std::string &before) {
    return {getName(), [this, before] {
              std::string now = value;
              value = before;
              return change(now);
            }};
  }

public:
  std::string value;
  TextParam(ofx::Param::Descriptor &d, ofx::Param::SetInstance *s) : StringInstance(d, s) {
    value = d.getProperties().getStringProperty(kOfxParamPropDefault);
  }
  OfxStatus get(std::string &v) override { v = value; return kOfxStatOK; }
  OfxStatus get(OfxTime, std::string &v) override { v = value; return kOfxStatOK; }
  OfxStatus set(const char *v) override {
    std::string before = value;
    history().add(change(before));
    value = v;
    return kOfxStatOK;
  }
  OfxStatus set(OfxTime, const char *v) override { return set(v); }
  // The library's own versions keep the text in a member, which concurrent readers would overwrite.
  OfxStatus getV(va_list arg) override { *va_arg(arg, const char **) = value.c_str(); return kOfxStatOK; }
  OfxStatus getV(OfxTime, va_list arg) override { *va_arg(arg, const char **) = value.c_str(); return kOfxStatOK; }
};

// ---------------------------------------------------------------- images

struct Depth {
  std::string name;
  size_t size;
};

Depth depth_of(const std::string &name) {
  if (name == kOfxBitDepthByte) return {name, 1};
  if (name == kOfxBitDepthShort || name == kOfxBitDepthHalf) return {name, 2};
  return {name, 4};
}

size_t channels_of(const std::string &components) {
  if (components == kOfxImageComponentRGBA) return 4;
  if (components == kOfxImageComponentRGB) return 3;
  return 1;
}

void encode(const Depth &depth, float value, unsigned char *out) {
  float held = std::min(std::max(value, 0.0f), 1.0f);
  if (depth.name == kOfxBitDepthByte) {
    *out = static_cast<unsigned char>(std::lround(held * 255));
  } else if (depth.name == kOfxBitDepthShort) {
    unsigned short v = static_cast<unsigned short>(std::lround(held * 65535));
    memcpy(out, &v, 2);
  } else if (depth.name == kOfxBitDepthHalf) {
    uint16_t v = to_half(value);
    memcpy(out, &v, 2);
  } else {
    memcpy(out, &value, 4);
  }
}

float decode(const Depth &depth, const unsigned char *in) {
  uint16_t two;
  float four;
  if (depth.name == kOfxBitDepthByte) return *in / 255.0f;
  memcpy(&two, in, 2);
  if (depth.name == kOfxBitDepthShort) return two / 65535.0f;
  if (depth.name == kOfxBitDepthHalf) return from_half(two);
  memcpy(&four, in, 4);
  return four;
}

// Pixels in memory. Rows begin with the bottom or the top row, unused bytes follow each row, and guard bytes are on both
// sides.
struct Buffer {
  OfxRectI bounds;
  Depth depth;
  size_t channels, stride;
  bool top_down;
  std::vector<unsigned char> bytes;

  Buffer(OfxRectI b, Depth d, size_t c, int padding, bool top_down)
      : bounds(b), depth(d), channels(c), stride((b.x2 - b.x1) * c * d.size + padding), top_down(top_down),
        bytes(2 * kGuard + stride * std::max(b.y2 - b.y1, 0), kCanary) {}

  int rows() const { return bounds.y2 - bounds.y1; }
  size_t offset(int x, int y) const {
    int row = top_down ? bounds.y2 - 1 - y : y - bounds.y1;
    return kGuard + row * stride + (x - bounds.x1) * channels * depth.size;
  }
  unsigned char *lowest_row() { return bytes.data() + (rows() > 0 ? offset(bounds.x1, bounds.y1) : kGuard); }
  int row_bytes() const { return top_down ? -int(stride) : int(stride); }
};

class FetchedImage : public fx::Image {
public:
  FetchedImage(fx::ClipInstance &clip, double scale, std::shared_ptr<Buffer> buffer, const OfxRectI &rod)
      : Image(clip, scale, scale, buffer->lowest_row(), buffer->bounds, rod, buffer->row_bytes(), kOfxImageFieldNone,
              "image"),
        buffer(buffer) {
    ++controls().live_images;
  }
  ~FetchedImage() override { --controls().live_images; }

private:
  std::shared_ptr<Buffer> buffer;
};

struct Frame {
  int width, height;
  std::vector<float> rgba;
};

class TestEffect;

class TestClip : public fx::ClipInstance {
public:
  TestClip(TestEffect *effect, fx::ClipDescriptor *descriptor);

  ClipSettings settings;
  std::map<double, Frame> frames;
  std::shared_ptr<Buffer> target;
  bool has_interest = false;
  OfxRectD interest;

  const std::string &getUnmappedBitDepth() const override { return depth_; }
  const std::string &getUnmappedComponents() const override { return components_; }
  const std::string &getPremult() const override;
  double getAspectRatio() const override { return settings.aspect; }
  double getFrameRate() const override { return 24; }
  void getFrameRange(double &first, double &last) const override { first = settings.first, last = settings.last; }
  const std::string &getFieldOrder() const override { return none_; }
  bool getConnected() const override { return settings.connected; }
  double getUnmappedFrameRate() const override { return 24; }
  void getUnmappedFrameRange(double &first, double &last) const override { getFrameRange(first, last); }
  bool getContinuousSamples() const override { return false; }
  OfxRectD getRegionOfDefinition(OfxTime) const override {
    return {settings.x1 * settings.aspect, double(settings.y1), settings.x2 * settings.aspect, double(settings.y2)};
  }
  fx::Image *getImage(OfxTime time, const OfxRectD *bounds) override;
  const std::string &findSupportedComp(const std::string &s) const override {
    // The library has no mapping for RGB.
    return isSupportedComponent(s) ? s : ClipInstance::findSupportedComp(s);
  }
  void adopt(const ClipSettings &s) {
    settings = s;
    depth_ = s.connected ? std::string(s.depth) : kOfxBitDepthNone;
    components_ = s.connected ? std::string(s.components) : kOfxImageComponentNone;
    premult_ = std::string(s.premultiplication);
  }
  OfxRectI pixels(double scale) const {
    return {int(std::floor(settings.x1 * scale)), int(std::floor(settings.y1 * scale)),
            int(std::ceil(settings.x2 * scale)), int(std::ceil(settings.y2 * scale))};
  }

private:
  TestEffect *effect_;
  std::string depth_, components_, premult_, none_ = kOfxImageFieldNone;
  std::shared_ptr<Buffer> draw(OfxTime time, const OfxRectI &bounds, double scale);
};

// ---------------------------------------------------------------- the effect and the host

// Records the messages to the user.
template <class Base> class Recording : public Base {
public:
  using Base::Base;
  OfxStatus vmessage(const char *type, const char *, const char *format, va_list args) override {
    say(type, format, args);
    return kOfxStatOK;
  }
  OfxStatus setPersistentMessage(const char *type, const char *, const char *format, va_list args) override {
    say(type, format, args);
    return kOfxStatOK;
  }
  OfxStatus clearPersistentMessage() override { return kOfxStatOK; }
};

class TestEffect : public Recording<fx::Instance> {
public:
  TestEffect(fx::ImageEffectPlugin *plugin, fx::Descriptor &descriptor, const std::string &context)
      : Recording(plugin, descriptor, context, false) {}

  std::atomic<double> scale{1};
  // The time of the action.
  std::atomic<double> now{0};
  double gone_to = NAN;
  // What happens at the next update of a progress display, and the statuses of what has happened.
  std::deque<std::function<std::string()>> meanwhile;
  std::vector<std::string> meanwhile_statuses;

  TestClip *clip(const std::string &name) const { return dynamic_cast<TestClip *>(getClip(name)); }
  const std::string &getDefaultOutputFielding() const override {
    static const std::string none(kOfxImageFieldNone);
    return none;
  }
  int abort() override {
    int left = controls().aborts_left;
    if (left < 0) return 0;
    return controls().aborts_left.fetch_sub(left > 0 ? 1 : 0) <= 0;
  }
  fx::ClipInstance *newClipInstance(fx::Instance *, fx::ClipDescriptor *descriptor, int) override {
    return new TestClip(this, descriptor);
  }
  void getProjectSize(double &x, double &y) const override {
    TestClip *out = clip("Output");
    x = (out->settings.x2 - out->settings.x1) * out->settings.aspect, y = out->settings.y2 - out->settings.y1;
  }
  void getProjectOffset(double &x, double &y) const override {
    TestClip *out = clip("Output");
    x = out->settings.x1 * out->settings.aspect, y = out->settings.y1;
  }
  void getProjectExtent(double &x, double &y) const override { getProjectSize(x, y); }
  double getProjectPixelAspectRatio() const override { return clip("Output")->settings.aspect; }
  double getEffectDuration() const override { return 100; }
  double getFrameRate() const override { return 24; }
  double getFrameRecursive() const override { return 0; }
  void getRenderScaleRecursive(double &x, double &y) const override { x = y = scale; }
  ofx::Param::Instance *newParam(const std::string &, ofx::Param::Descriptor &d) override {
    const std::string &type = d.getType();
    if (type == kOfxParamTypeInteger) return new IntegerParam(d, this);
    if (type == kOfxParamTypeDouble) return new DoubleParam(d, this);
    if (type == kOfxParamTypeBoolean) return new BooleanParam(d, this);
    if (type == kOfxParamTypeChoice) return new ChoiceParam(d, this);
    if (type == kOfxParamTypeDouble2D) return new PairParam(d, this);
    if (type == kOfxParamTypeRGB) return new ShadeParam(d, this);
    if (type == kOfxParamTypeRGBA) return new ColourParam(d, this);
    if (type == kOfxParamTypeString) return new TextParam(d, this);
    if (type == kOfxParamTypePushButton) return new ofx::Param::PushbuttonInstance(d, this);
    if (type == kOfxParamTypeGroup) return new ofx::Param::GroupInstance(d, this);
    if (type == kOfxParamTypePage) return new ofx::Param::PageInstance(d, this);
    return nullptr;
  }
  OfxStatus editBegin(const std::string &label) override { return history().begin(label), kOfxStatOK; }
  OfxStatus editEnd() override { return history().end(), kOfxStatOK; }
  void progressStart(const std::string &, const std::string &) override {}
  void progressEnd() override {}
  bool progressUpdate(double t) override {
    controls().progress = std::max(controls().progress.load(), t);
    while (!meanwhile.empty()) {
      std::function<std::string()> event = meanwhile.front();
      meanwhile.pop_front();
      meanwhile_statuses.push_back(event());
    }
    int left = controls().cancels_left;
    if (left < 0) return true;
    return controls().cancels_left.fetch_sub(left > 0 ? 1 : 0) > 0;
  }
  double timeLineGetTime() override { return 0; }
  // As in a real host, the viewer asks for the picture of the new time before this returns.
  void timeLineGotoTime(double time) override {
    gone_to = time;
    OfxRectD region = {0, 0, 0, 0};
    getRegionOfDefinitionAction(time, {1, 1}, region);
  }
  void timeLineGetBounds(double &first, double &last) override { first = 0, last = 100; }
};

TestClip::TestClip(TestEffect *effect, fx::ClipDescriptor *descriptor)
    : ClipInstance(effect, *descriptor), effect_(effect) {
  ClipSettings s;
  s.depth = kOfxBitDepthFloat, s.components = kOfxImageComponentRGBA, s.premultiplication = kOfxImagePreMultiplied;
  s.connected = descriptor->isOutput() || !descriptor->isOptional();
  s.x1 = s.y1 = 0, s.x2 = 64, s.y2 = 48, s.aspect = 1, s.first = 0, s.last = 10;
  s.padding = s.margin = 0, s.top_down = false;
  adopt(s);
}

const std::string &TestClip::getPremult() const {
  return isOutput() ? effect_->getOutputPreMultiplication() : premult_;
}

fx::Image *TestClip::getImage(OfxTime time, const OfxRectD *region) {
  if (controls().no_images || !settings.connected) return nullptr;
  if (!controls().temporal && time != effect_->now) return nullptr;
  // A host may give pixels at another scale than it says.
  double scale = effect_->scale * controls().real_scale;
  if (isOutput()) return target ? new FetchedImage(*this, scale, target, pixels(scale)) : nullptr;
  OfxRectI whole = pixels(scale), bounds = whole;
  const OfxRectD *asked = region ? region : has_interest ? &interest : nullptr;
  if (asked) {
    double x = scale / settings.aspect;
    bounds.x1 = std::max(whole.x1, int(std::floor(asked->x1 * x)) - settings.margin);
    bounds.y1 = std::max(whole.y1, int(std::floor(asked->y1 * scale)) - settings.margin);
    bounds.x2 = std::min(whole.x2, int(std::ceil(asked->x2 * x)) + settings.margin);
    bounds.y2 = std::min(whole.y2, int(std::ceil(asked->y2 * scale)) + settings.margin);
    if (bounds.x1 >= bounds.x2 || bounds.y1 >= bounds.y2) return nullptr;
  }
  return new FetchedImage(*this, scale, draw(time, bounds, scale), whole);
}

// The frame's picture at a scale. Each pixel is the mean of the full-size pixels that it covers. Pixels outside the frame
// are transparent.
std::shared_ptr<Buffer> TestClip::draw(OfxTime time, const OfxRectI &bounds, double scale) {
  auto buffer = std::make_shared<Buffer>(bounds, depth_of(getPixelDepth()), channels_of(getComponents()),
                                         settings.padding, settings.top_down);
  auto found = frames.find(time);
  int step = std::max(1, int(std::lround(1 / scale)));
  for (int y = bounds.y1; y < bounds.y2; ++y) {
    for (int x = bounds.x1; x < bounds.x2; ++x) {
      float pixel[4] = {0, 0, 0, 0};
      for (int j = 0; j < step * step && found != frames.end(); ++j) {
        int u = x * step + j % step - settings.x1, v = y * step + j / step - settings.y1;
        const Frame &frame = found->second;
        if (u < 0 || v < 0 || u >= frame.width || v >= frame.height) continue;
        for (int c = 0; c < 4; ++c) pixel[c] += frame.rgba[4 * (size_t(v) * frame.width + u) + c] / (step * step);
      }
      unsigned char *out = buffer->bytes.data() + buffer->offset(x, y);
      size_t n = buffer->channels;
      for (size_t c = 0; c < n; ++c) encode(buffer->depth, n == 1 ? pixel[3] : pixel[c], out + c * buffer->depth.size);
    }
  }
  return buffer;
}

OfxStatus draw_set_colour(OfxDrawContextHandle, const OfxRGBAColourF *c) {
  glColor4f(c->r, c->g, c->b, c->a);
  return kOfxStatOK;
}
OfxStatus draw_get_colour(OfxDrawContextHandle, OfxStandardColour, OfxRGBAColourF *) { return kOfxStatFailed; }
OfxStatus draw_set_width(OfxDrawContextHandle, float width) { return glLineWidth(width), kOfxStatOK; }
OfxStatus draw_set_stipple(OfxDrawContextHandle, OfxDrawLineStipplePattern) { return kOfxStatOK; }
OfxStatus draw_primitive(OfxDrawContextHandle, OfxDrawPrimitive primitive, const OfxPointD *points, int count) {
  begin_line();
  drawn_lines().push_back(primitive == kOfxDrawPrimitiveLineLoop);
  drawn_lines().push_back(count);
  for (int i = 0; i < count; ++i) {
    drawn_lines().push_back(points[i].x);
    drawn_lines().push_back(points[i].y);
  }
  return kOfxStatOK;
}
OfxStatus draw_text(OfxDrawContextHandle, const char *text, const OfxPointD *, int) {
  drawn_texts().push_back(text);
  return kOfxStatOK;
}
OfxDrawSuiteV1 draw_suite_v1 = {draw_get_colour, draw_set_colour, draw_set_width,
                                draw_set_stipple, draw_primitive, draw_text};

// Natron's developers report of Resolve 14 that one function is null, and the other one an address of nothing.
const OfxMessageSuiteV2 *null_messages() {
  static OfxMessageSuiteV2 suite = {};
  suite.clearPersistentMessage = reinterpret_cast<OfxStatus (*)(void *)>(uintptr_t(8));
  return &suite;
}

class TestOverlay : public fx::OverlayInteract {
public:
  explicit TestOverlay(fx::Instance &effect) : OverlayInteract(effect) {}
  double pixel = 1;
  void getPixelScale(double &x, double &y) const override { x = y = pixel; }
  void getBackgroundColour(double &r, double &g, double &b) const override { r = g = b = 0; }
  bool getSuggestedColour(double &, double &, double &) const override { return false; }
  OfxStatus swapBuffers() override { return kOfxStatOK; }
  OfxStatus redraw() override { return kOfxStatOK; }
#ifdef kOfxInteractPropViewportSize
  void getViewportSize(double &x, double &y) const override { x = y = 100; }
#endif
};

class TestHost : public Recording<fx::Host> {
public:
  TestHost() {
    _properties.setIntProperty(kOfxPropAPIVersion, 1, 0);
    _properties.setIntProperty(kOfxPropAPIVersion, 4, 1);
    const char *components[] = {kOfxImageComponentRGBA, kOfxImageComponentRGB, kOfxImageComponentAlpha};
    for (int i = 0; i < 3; ++i) _properties.setStringProperty(kOfxImageEffectPropSupportedComponents, components[i], i);
    const char *depths[] = {kOfxBitDepthByte, kOfxBitDepthShort, kOfxBitDepthHalf, kOfxBitDepthFloat};
    for (int i = 0; i < 4; ++i) _properties.setStringProperty(kOfxImageEffectPropSupportedPixelDepths, depths[i], i);
    const char *contexts[] = {kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral,
                              kOfxImageEffectContextGenerator};
    for (int i = 0; i < 3; ++i) _properties.setStringProperty(kOfxImageEffectPropSupportedContexts, contexts[i], i);
  }
  void configure(const Settings &settings) {
    _properties.setStringProperty(kOfxPropName, std::string(settings.name));
    _properties.setStringProperty(kOfxPropLabel, std::string(settings.name));
    _properties.setIntProperty(kOfxImageEffectPropSupportsMultiResolution, settings.multi_resolution);
    _properties.setIntProperty(kOfxImageEffectPropSupportsTiles, settings.tiles);
    _properties.setIntProperty(kOfxImageEffectPropTemporalClipAccess, settings.temporal);
    _properties.setIntProperty(kOfxParamHostPropSupportsChoiceAnimation, settings.choice_keys);
    natron("NatronOfxParamHostPropSupportsDynamicChoices", settings.menus);
    natron("NatronOfxHostIsNatron", settings.natron);
  }
  const void *fetchSuite(const char *name, int version) override {
    for (const std::string &missing : controls().missing_suites)
      if (missing == name || missing == std::string(name) + "/" + std::to_string(version)) return nullptr;
    if (strcmp(name, kOfxDrawSuite) == 0) return version == 1 ? &draw_suite_v1 : nullptr;
    if (strcmp(name, kOfxMessageSuite) == 0 && version == 2 && controls().null_messages) return null_messages();
    return fx::Host::fetchSuite(name, version);
  }
  fx::Instance *newInstance(void *, fx::ImageEffectPlugin *plugin, fx::Descriptor &descriptor,
                            const std::string &context) override {
    return new TestEffect(plugin, descriptor, context);
  }
  fx::Descriptor *makeDescriptor(fx::ImageEffectPlugin *plugin) override {
    fx::Descriptor *descriptor = new fx::Descriptor(plugin);
    // The library supports OpenFX 1.4, which does not have this property.
    static const ofx::Property::PropSpec newer[] = {
        {kOfxImageEffectPluginPropOverlayInteractV2, ofx::Property::ePointer, 1, false, nullptr},
        ofx::Property::propSpecEnd};
    descriptor->getProps().addProperties(newer);
    return descriptor;
  }
  fx::Descriptor *makeDescriptor(const fx::Descriptor &root, fx::ImageEffectPlugin *plugin) override {
    return new fx::Descriptor(root, plugin);
  }
  fx::Descriptor *makeDescriptor(const std::string &path, fx::ImageEffectPlugin *plugin) override {
    return new fx::Descriptor(path, plugin);
  }

  OfxStatus multiThread(OfxThreadFunctionV1 function, unsigned int n, void *argument) override {
    if (spawned_) return kOfxStatErrExists;
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < n; ++i)
      threads.emplace_back([=] {
        spawned_ = true, index_ = i;
        function(i, n, argument);
      });
    for (std::thread &thread : threads) thread.join();
    return kOfxStatOK;
  }
  OfxStatus multiThreadNumCPUS(unsigned int *n) const override { return *n = controls().cpus, kOfxStatOK; }
  OfxStatus multiThreadIndex(unsigned int *index) const override { return *index = index_, kOfxStatOK; }
  int multiThreadIsSpawnedThread() const override { return spawned_; }
  OfxStatus mutexCreate(OfxMutexHandle *mutex, int) override {
    *mutex = reinterpret_cast<OfxMutexHandle>(new std::recursive_mutex);
    return kOfxStatOK;
  }
  OfxStatus mutexDestroy(const OfxMutexHandle m) override { return delete held(m), kOfxStatOK; }
  OfxStatus mutexLock(const OfxMutexHandle m) override { return held(m)->lock(), kOfxStatOK; }
  OfxStatus mutexUnLock(const OfxMutexHandle m) override { return held(m)->unlock(), kOfxStatOK; }
  OfxStatus mutexTryLock(const OfxMutexHandle m) override { return held(m)->try_lock() ? kOfxStatOK : kOfxStatFailed; }

private:
  // Sets one of Natron's properties. Other hosts have none of them.
  void natron(const char *name, bool value) {
    const ofx::Property::PropSpec specs[] = {{name, ofx::Property::eInt, 1, false, "0"}, ofx::Property::propSpecEnd};
    if (value && !_properties.fetchProperty(name)) _properties.addProperties(specs);
    if (_properties.fetchProperty(name)) _properties.setIntProperty(name, value);
  }
  static std::recursive_mutex *held(OfxMutexHandle m) { return reinterpret_cast<std::recursive_mutex *>(m); }
  static thread_local bool spawned_;
  static thread_local unsigned index_;
};

thread_local bool TestHost::spawned_ = false;
thread_local unsigned TestHost::index_ = 0;

TestHost &host() {
  static LineLog log;
  static TestHost instance;
  static bool first = true;
  if (first) std::cout.rdbuf(&log), first = false;
  return instance;
}

std::unique_ptr<fx::PluginCache> &cache() {
  static std::unique_ptr<fx::PluginCache> instance;
  return instance;
}

rust::Vec<rust::String> moved(std::vector<std::string> &from) {
  rust::Vec<rust::String> to;
  std::lock_guard<std::mutex> lock(controls().mutex);
  for (const std::string &line : from) to.push_back(rust::String::lossy(line));
  from.clear();
  return to;
}

OfxRectI rect(const Bounds &b) { return {b.x1, b.y1, b.x2, b.y2}; }

} // namespace

// ---------------------------------------------------------------- functions that Rust calls

void open(rust::Str folder) {
  host();
  // A new cache forgets the plugins of the last folder. The library also scans OFX_PLUGIN_PATH and /usr/OFX/Plugins.
  ofx::PluginCache::clearPluginCache();
  cache().reset(new fx::PluginCache(host()));
  ofx::PluginCache *global = ofx::PluginCache::getPluginCache();
  global->setCacheVersion("rototoon");
  cache()->registerInCache(*global);
  global->addFileToPath(text_of(folder));
  global->scanPluginFiles();
}

void close() {
  ofx::PluginCache::clearPluginCache();
  cache().reset();
}

rust::Vec<rust::String> plugins() {
  rust::Vec<rust::String> ids;
  for (fx::ImageEffectPlugin *plugin : cache()->getPlugins()) ids.push_back(plugin->getRawIdentifier());
  return ids;
}

rust::Vec<rust::String> contexts(rust::Str id) {
  rust::Vec<rust::String> names;
  if (fx::ImageEffectPlugin *plugin = cache()->getPluginById(text_of(id)))
    for (const std::string &name : plugin->getContexts()) names.push_back(name);
  return names;
}

void configure(const Settings &settings) {
  host().configure(settings);
  controls().missing_suites.clear();
  for (const rust::String &name : settings.missing_suites) controls().missing_suites.push_back(std::string(name));
  controls().aborts_left = settings.abort_after;
  controls().cancels_left = settings.cancel_after;
  controls().no_images = settings.no_images;
  controls().real_scale = settings.real_scale;
  controls().cpus = settings.cpus;
  controls().menus = settings.menus;
  controls().temporal = settings.temporal;
  controls().null_messages = settings.null_messages;
  controls().viewer_draws = settings.viewer_draws;
  controls().progress = 0;
}

rust::Vec<rust::String> take_log() { return moved(controls().log); }
rust::Vec<rust::String> take_messages() { return moved(controls().messages); }
int live_images() { return controls().live_images; }
double furthest_progress() { return controls().progress; }

class EffectImpl {
public:
  std::unique_ptr<TestEffect> effect;
  OfxRectI window{0, 0, 0, 0};
  std::shared_ptr<Buffer> output;
};

Effect::Effect(rust::Str id, rust::Str context) : impl(new EffectImpl) {
  fx::ImageEffectPlugin *plugin = cache()->getPluginById(text_of(id));
  if (plugin) impl->effect.reset(dynamic_cast<TestEffect *>(plugin->createInstance(text_of(context), nullptr)));
}
Effect::~Effect() {}

std::unique_ptr<Effect> new_effect(rust::Str id, rust::Str context) {
  return std::unique_ptr<Effect>(new Effect(id, context));
}

bool Effect::valid() const { return impl->effect != nullptr; }

void Effect::set_clip(rust::Str name, const ClipSettings &settings) {
  if (TestClip *clip = impl->effect->clip(text_of(name))) clip->adopt(settings);
}

void Effect::set_frame(rust::Str name, double time, int width, int height, rust::Slice<const float> rgba) {
  if (TestClip *clip = impl->effect->clip(text_of(name)))
    clip->frames[time] = Frame{width, height, std::vector<float>(rgba.begin(), rgba.end())};
}

rust::String Effect::create() {
  rototoon_host::history() = History();
  OfxStatus status = impl->effect->createInstanceAction();
  if (status != kOfxStatOK && status != kOfxStatReplyDefault) return status_name(status);
  return impl->effect->getClipPreferences() ? status_name(status) : "GetClipPreferences failed";
}

rust::String Effect::destroy() {
  impl->effect.reset();
  return "kOfxStatOK";
}

rust::String Effect::preferences() {
  if (!impl->effect->getClipPreferences()) return "failed";
  TestClip *clip = impl->effect->clip("Output");
  return clip->getPixelDepth() + " " + clip->getComponents() + " " + clip->getPremult();
}

rust::String Effect::render(double time, const Bounds &bounds, double scale, int threads, int tile_rows) {
  TestEffect *effect = impl->effect.get();
  TestClip *out = effect->clip("Output");
  effect->scale = scale, effect->now = time;
  OfxPointD scales = {scale, scale};
  OfxRectI window = rect(bounds), larger = window;
  int margin = out->settings.margin;
  larger.x1 -= margin, larger.y1 -= margin, larger.x2 += margin, larger.y2 += margin;
  out->target = std::make_shared<Buffer>(larger, depth_of(out->getPixelDepth()), channels_of(out->getComponents()),
                                         out->settings.padding, out->settings.top_down);
  impl->output = out->target;
  impl->window = window;
  double aspect = out->settings.aspect;
  OfxRectD region = {window.x1 / scale * aspect, window.y1 / scale, window.x2 / scale * aspect, window.y2 / scale};
  std::map<fx::ClipInstance *, OfxRectD> interests;
  effect->getRegionOfInterestAction(time, scales, region, interests);
  for (auto &entry : interests) {
    TestClip *clip = dynamic_cast<TestClip *>(entry.first);
    clip->interest = entry.second, clip->has_interest = true;
  }
  OfxStatus begun = effect->beginRenderAction(time, time, 1, false, scales, true, false);
  if (begun != kOfxStatOK && begun != kOfxStatReplyDefault) return status_name(begun);
  std::vector<OfxRectI> tiles;
  int rows = tile_rows > 0 ? tile_rows : std::max(window.y2 - window.y1, 1);
  for (int y = window.y1; y < window.y2 || tiles.empty(); y += rows)
    tiles.push_back({window.x1, y, window.x2, std::min(y + rows, window.y2)});
  std::atomic<size_t> next{0};
  std::atomic<int> worst{kOfxStatOK};
  auto work = [&] {
    for (size_t i = next++; i < tiles.size(); i = next++) {
      OfxStatus status = effect->renderAction(time, kOfxImageFieldNone, tiles[i], scales, true, false, false);
      if (status != kOfxStatOK) worst = status;
    }
  };
  // Hosts draw the overlay on their own thread, also before and after the tiles.
  std::atomic<bool> done{false};
  std::thread viewer([&] {
    while (controls().viewer_draws && !done)
      if (text_of(overlay("OfxInteractActionDraw", true, time, Pen{0, 0, 1, 0, 1})) != "kOfxStatOK") worst = kOfxStatFailed;
  });
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread &thread : pool) thread.join();
  done = true;
  viewer.join();
  effect->endRenderAction(time, time, 1, false, scales, true, false);
  out->target.reset();
  for (auto &entry : interests) dynamic_cast<TestClip *>(entry.first)->has_interest = false;
  effect->scale = 1;
  return status_name(worst);
}

Picture Effect::output() const {
  Picture picture;
  picture.damage = picture.untouched = picture.width = picture.height = picture.channels = 0;
  if (!impl->output) return picture;
  Buffer &buffer = *impl->output;
  std::vector<unsigned char> rest = buffer.bytes;
  OfxRectI w = impl->window;
  size_t n = buffer.channels, pixel = n * buffer.depth.size;
  picture.width = std::max(w.x2 - w.x1, 0), picture.height = std::max(w.y2 - w.y1, 0), picture.channels = n;
  for (int y = w.y1; y < w.y2; ++y) {
    for (int x = w.x1; x < w.x2; ++x) {
      unsigned char *at = rest.data() + buffer.offset(x, y);
      // A short pixel may have the canary's value by chance.
      bool touched = pixel < 12;
      for (size_t i = 0; i < pixel; ++i) touched = touched || at[i] != kCanary;
      picture.untouched += !touched;
      for (size_t c = 0; c < n; ++c) picture.values.push_back(decode(buffer.depth, at + c * buffer.depth.size));
      std::fill(at, at + pixel, kCanary);
    }
  }
  for (unsigned char byte : rest) picture.damage += byte != kCanary;
  return picture;
}

Region Effect::region_of_definition(double time, double scale) {
  OfxRectD r = {0, 0, 0, 0};
  OfxStatus status = impl->effect->getRegionOfDefinitionAction(time, {scale, scale}, r);
  return Region{status_name(status), r.x1, r.y1, r.x2, r.y2};
}

Region Effect::region_of_interest(rust::Str name, double time, double scale, const Region &wanted) {
  std::map<fx::ClipInstance *, OfxRectD> interests;
  OfxRectD region = {wanted.x1, wanted.y1, wanted.x2, wanted.y2};
  OfxStatus status = impl->effect->getRegionOfInterestAction(time, {scale, scale}, region, interests);
  OfxRectD r = interests[impl->effect->clip(text_of(name))];
  return Region{status_name(status), r.x1, r.y1, r.x2, r.y2};
}

rust::String Effect::identity(double time, const Bounds &window, double scale) {
  std::string clip;
  OfxTime at = time;
  OfxStatus status = impl->effect->isIdentityAction(at, kOfxImageFieldNone, rect(window), {scale, scale}, clip);
  return status == kOfxStatOK ? clip : "";
}

bool Effect::varies() const { return impl->effect->isFrameVarying(); }

rust::Vec<double> Effect::frames_needed(rust::Str name, double time) {
  fx::RangeMap ranges;
  impl->effect->getFrameNeededAction(time, ranges);
  rust::Vec<double> flat;
  for (const OfxRangeD &range : ranges[impl->effect->clip(text_of(name))]) {
    flat.push_back(range.min);
    flat.push_back(range.max);
  }
  return flat;
}

rust::Vec<rust::String> Effect::parameters() const {
  rust::Vec<rust::String> names;
  for (ofx::Param::Instance *param : impl->effect->getParamList()) names.push_back(param->getName());
  return names;
}

rust::String Effect::parameter_property(rust::Str name, rust::Str property, int index) const {
  ofx::Param::Instance *param = impl->effect->getParam(text_of(name));
  if (!param) return "";
  ofx::Property::Property *found = nullptr;
  const ofx::Property::PropertyMap &all = param->getProperties().getProperties();
  auto at = all.find(text_of(property));
  if (at == all.end()) return "";
  found = at->second;
  if (index >= found->getDimension()) return "";
  return rust::String::lossy(found->getStringValue(index));
}

static Numbers *numbers_of(EffectImpl &impl, rust::Str name) {
  return dynamic_cast<Numbers *>(impl.effect->getParam(text_of(name)));
}

void Effect::set_numbers(rust::Str name, rust::Slice<const double> values) {
  if (Numbers *param = numbers_of(*impl, name)) param->track.value.assign(values.begin(), values.end());
}

void Effect::set_numbers_at(rust::Str name, double time, rust::Slice<const double> values) {
  if (Numbers *param = numbers_of(*impl, name)) param->track.keys[time].assign(values.begin(), values.end());
}

rust::Vec<double> Effect::key_times(rust::Str name) const {
  rust::Vec<double> times;
  if (Numbers *param = numbers_of(*impl, name))
    for (const auto &key : param->track.keys) times.push_back(key.first);
  return times;
}

double Effect::gone_to() const { return impl->effect->gone_to; }

rust::Vec<double> Effect::numbers(rust::Str name, double time) const {
  rust::Vec<double> values;
  if (Numbers *param = numbers_of(*impl, name))
    for (double v : param->track.at(time)) values.push_back(v);
  return values;
}

void Effect::set_text(rust::Str name, rust::Str value) {
  if (TextParam *param = dynamic_cast<TextParam *>(impl->effect->getParam(text_of(name)))) param->value = text_of(value);
}

rust::String Effect::text(rust::Str name) const {
  TextParam *param = dynamic_cast<TextParam *>(impl->effect->getParam(text_of(name)));
  return param ? rust::String::lossy(param->value) : rust::String();
}

rust::String Effect::changed(rust::Str name, rust::Str reason, double time) {
  std::string why = text_of(reason);
  impl->effect->now = time;
  impl->effect->beginInstanceChangedAction(why);
  OfxStatus status = impl->effect->paramInstanceChangedAction(text_of(name), why, time, {1, 1});
  impl->effect->endInstanceChangedAction(why);
  return status_name(status);
}

rust::String Effect::clip_changed(rust::Str name) {
  std::string why = kOfxChangeUserEdited;
  impl->effect->beginInstanceChangedAction(why);
  OfxStatus status = impl->effect->clipInstanceChangedAction(text_of(name), why, 0, {1, 1});
  impl->effect->endInstanceChangedAction(why);
  return status_name(status);
}

void Effect::meanwhile(rust::Str kind, rust::Str name, rust::Str text, rust::Slice<const double> numbers) {
  std::string k = text_of(kind), n = text_of(name), words = text_of(text);
  std::vector<double> v(numbers.begin(), numbers.end());
  impl->effect->meanwhile.push_back([this, k, n, words, v]() -> std::string {
    if (k == "set") set_numbers(n, {v.data(), v.size()});
    if (k == "text") set_text(n, words);
    if (k == "frame") {
      std::vector<float> pixels(v.begin() + 2, v.end());
      set_frame(n, v[0], int(v[1]), int(pixels.size() / 4 / v[1]), {pixels.data(), pixels.size()});
      return "";
    }
    if (k == "undo") return undo(false, false), "";
    if (k == "action") return std::string(action(n));
    if (k == "clip") return std::string(clip_changed(n));
    if (k == "pen") return std::string(overlay(n, true, v[0], Pen{v[1], v[2], v[3], int(v[4])}));
    if (k == "render") return std::string(render(v[0], Bounds{int(v[1]), int(v[2]), int(v[3]), int(v[4])}, 1, 1, 0));
    return std::string(changed(n, kOfxChangeUserEdited, 0));
  });
}

rust::Vec<rust::String> Effect::meanwhile_statuses() {
  rust::Vec<rust::String> statuses;
  for (const std::string &status : impl->effect->meanwhile_statuses) statuses.push_back(status);
  impl->effect->meanwhile_statuses.clear();
  return statuses;
}

rust::String Effect::action(rust::Str name) {
  return status_name(impl->effect->mainEntry(text_of(name).c_str(), impl->effect->getHandle(), nullptr, nullptr));
}

rust::Vec<float> Effect::drawn_colours() const {
  rust::Vec<float> colours;
  for (float v : line_colours()) colours.push_back(v);
  return colours;
}

rust::Vec<rust::String> Effect::texts() const {
  rust::Vec<rust::String> texts;
  for (const std::string &text : drawn_texts()) texts.push_back(rust::String::lossy(text));
  return texts;
}

rust::Vec<double> Effect::drawn() const {
  rust::Vec<double> lines;
  for (double v : drawn_lines()) lines.push_back(v);
  return lines;
}

rust::Vec<rust::String> Effect::history() const {
  rust::Vec<rust::String> labels;
  for (const Step &step : rototoon_host::history().steps) labels.push_back(rust::String::lossy(step.label));
  return labels;
}

// Takes the last step of one list back, and puts its opposite into the other list.
static void turn(Effect &effect, std::vector<Step> &from, std::vector<Step> &to, bool told, bool between) {
  if (from.empty()) return;
  Step last = from.back(), opposite = {last.label, {}};
  from.pop_back();
  std::vector<std::string> names;
  for (auto back = last.back.rbegin(); back != last.back.rend(); ++back) {
    opposite.back.push_back(back->turn());
    if (told && between) effect.changed(back->name, "OfxChangeUserEdited", 0);
    if (std::find(names.begin(), names.end(), back->name) == names.end()) names.push_back(back->name);
  }
  to.push_back(opposite);
  for (const std::string &name : names)
    if (told && !between) effect.changed(name, "OfxChangeUserEdited", 0);
}

void Effect::undo(bool told, bool between) {
  turn(*this, rototoon_host::history().steps, rototoon_host::history().undone, told, between);
}

void Effect::redo() { turn(*this, rototoon_host::history().undone, rototoon_host::history().steps, true, false); }

void Effect::set_numbers_in_history(rust::Str name, rust::Slice<const double> values) {
  if (Numbers *param = numbers_of(*impl, name)) param->remember();
  set_numbers(name, values);
}

void Effect::set_text_in_history(rust::Str name, rust::Str value) {
  if (TextParam *param = dynamic_cast<TextParam *>(impl->effect->getParam(text_of(name)))) param->set(text_of(value).c_str());
}

rust::String Effect::overlay(rust::Str name, bool draw_suite, double time, const Pen &pen) {
  drawn_lines().clear();
  drawn_texts().clear();
  line_colours().clear();
  const char *property =
      draw_suite ? kOfxImageEffectPluginPropOverlayInteractV2 : kOfxImageEffectPluginPropOverlayInteractV1;
  ofx::Property::Set &base = impl->effect->getPlugin()->getDescriptor().getProps();
  OfxPluginEntryPoint *entry = reinterpret_cast<OfxPluginEntryPoint *>(base.getPointerProperty(property));
  if (!entry) return "none";
  TestOverlay interact(*impl->effect);
  interact.pixel = pen.pixel;
  interact.createInstanceAction();
  static const ofx::Property::PropSpec specs[] = {
      {kOfxPropEffectInstance, ofx::Property::ePointer, 1, true, nullptr},
      {kOfxInteractPropDrawContext, ofx::Property::ePointer, 1, true, nullptr},
      {kOfxPropTime, ofx::Property::eDouble, 1, true, "0"},
      {kOfxImageEffectPropRenderScale, ofx::Property::eDouble, 2, true, "1"},
      {kOfxInteractPropPixelScale, ofx::Property::eDouble, 2, true, "1"},
      {kOfxInteractPropPenPosition, ofx::Property::eDouble, 2, true, "0"},
      {kOfxPropKeySym, ofx::Property::eInt, 1, true, "0"},
      ofx::Property::propSpecEnd};
  ofx::Property::Set arguments(specs);
  double scale[2] = {pen.pixel, pen.pixel}, place[2] = {pen.x, pen.y}, proxy[2] = {pen.scale, pen.scale};
  arguments.setPointerProperty(kOfxPropEffectInstance, impl->effect->getHandle());
  arguments.setPointerProperty(kOfxInteractPropDrawContext, &arguments);
  arguments.setDoubleProperty(kOfxPropTime, time);
  arguments.setDoublePropertyN(kOfxInteractPropPixelScale, scale, 2);
  arguments.setDoublePropertyN(kOfxImageEffectPropRenderScale, proxy, 2);
  arguments.setDoublePropertyN(kOfxInteractPropPenPosition, place, 2);
  arguments.setIntProperty(kOfxPropKeySym, pen.key);
  return status_name(entry(text_of(name).c_str(), interact.getHandle(), arguments.getHandle(), nullptr));
}

} // namespace rototoon_host
