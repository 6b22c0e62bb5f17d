// Values, keys and undo of the parameters.
#pragma once

#include "library.h"
#include "controls.h"
#include "history.h"

#include <cmath>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace rototoon_host {

struct Track {
  std::vector<double> value;
  std::map<double, std::vector<double>> keys;
  // The keys whose values are held until the next one. Others are interpolated linearly.
  std::set<double> held;

  std::vector<double> at(double time) const {
    if (keys.empty()) return value;
    auto after = keys.lower_bound(time);
    if (after == keys.end()) return keys.rbegin()->second;
    if (after == keys.begin() || after->first == time) return after->second;
    auto before = std::prev(after);
    if (held.count(before->first)) return before->second;
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
    track.held.erase(time);
    return kOfxStatOK;
  }
  OfxStatus deleteAllKeys() override {
    remember();
    // As in real hosts, the parameter keeps the value that it had.
    if (!track.keys.empty()) track.value = track.keys.begin()->second;
    track.keys.clear();
    track.held.clear();
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
    bool allowed = controls().menus && (count == 0 || index == count - 1);
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
    if (getCanUndo()) history().add(change(before));
    value = v;
    return kOfxStatOK;
  }
  OfxStatus set(OfxTime, const char *v) override { return set(v); }
  // The library's own versions keep the text in a member, which concurrent readers would overwrite.
  OfxStatus getV(va_list arg) override { *va_arg(arg, const char **) = value.c_str(); return kOfxStatOK; }
  OfxStatus getV(OfxTime, va_list arg) override { *va_arg(arg, const char **) = value.c_str(); return kOfxStatOK; }
};

// A parameter of the kind that a plugin describes. Null for a kind that the host does not know.
ofx::Param::Instance *new_param(ofx::Param::Descriptor &descriptor, ofx::Param::SetInstance *set);

} // namespace rototoon_host
