// An effect as Rust calls it: its clips, its actions but render, and what happens meanwhile.

#include "effect.h"

namespace rototoon_host {

OfxRectI rect(const Bounds &b) { return {b.x1, b.y1, b.x2, b.y2}; }

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

void Effect::set_region(rust::Str name, double time, const Bounds &region) {
  if (TestClip *clip = impl->effect->clip(text_of(name))) clip->regions[time] = rect(region);
}

void Effect::set_format(rust::Str name, const Bounds &format) {
  if (TestClip *clip = impl->effect->clip(text_of(name))) clip->set_format(format);
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

} // namespace rototoon_host
