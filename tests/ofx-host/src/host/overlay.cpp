// Events of the viewer, and what the overlay drew with them.

#include "effect.h"
#include "draw.h"

namespace rototoon_host {

namespace {

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

} // namespace

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
