// The parameters of an effect, and the undo of their changes.

#include "effect.h"

#include <algorithm>

namespace rototoon_host {

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

void Effect::hold_keys(rust::Str name) {
  if (Numbers *param = numbers_of(*impl, name))
    for (const auto &key : param->track.keys) param->track.held.insert(key.first);
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

} // namespace rototoon_host
