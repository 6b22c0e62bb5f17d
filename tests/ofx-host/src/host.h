// A small test host on top of the official HostSupport library. lib.rs says what each function does.
#pragma once

#include "rust/cxx.h"
#include <memory>

namespace rototoon_host {

struct Bounds;
struct Region;
struct Settings;
struct ClipSettings;
struct Picture;
struct Pen;

class EffectImpl;

class Effect {
public:
  explicit Effect(rust::Str id, rust::Str context);
  ~Effect();
  bool valid() const;
  void set_clip(rust::Str name, const ClipSettings &settings);
  void set_frame(rust::Str clip, double time, int width, int height, rust::Slice<const float> rgba);
  void set_region(rust::Str clip, double time, const Bounds &region);
  void set_format(rust::Str clip, const Bounds &format);
  rust::String create();
  rust::String destroy();
  rust::String render(double time, const Bounds &window, double scale, int threads, int tile_rows);
  Picture output() const;
  Region region_of_definition(double time, double scale);
  Region region_of_interest(rust::Str clip, double time, double scale, const Region &wanted);
  rust::String identity(double time, const Bounds &window, double scale);
  rust::Vec<double> frames_needed(rust::Str clip, double time);
  rust::String preferences();
  bool varies() const;
  rust::Vec<rust::String> parameters() const;
  rust::String parameter_property(rust::Str name, rust::Str property, int index) const;
  void set_numbers(rust::Str name, rust::Slice<const double> values);
  void set_numbers_at(rust::Str name, double time, rust::Slice<const double> values);
  void hold_keys(rust::Str name);
  rust::Vec<double> key_times(rust::Str name) const;
  double gone_to() const;
  rust::Vec<double> numbers(rust::Str name, double time) const;
  void set_text(rust::Str name, rust::Str value);
  void set_numbers_in_history(rust::Str name, rust::Slice<const double> values);
  void set_text_in_history(rust::Str name, rust::Str value);
  rust::String text(rust::Str name) const;
  rust::String changed(rust::Str name, rust::Str reason, double time);
  rust::String clip_changed(rust::Str name);
  void meanwhile(rust::Str kind, rust::Str name, rust::Str text, rust::Slice<const double> numbers);
  rust::Vec<rust::String> meanwhile_statuses();
  rust::String action(rust::Str name);
  rust::String overlay(rust::Str action, bool draw_suite, double time, const Pen &pen);
  rust::Vec<rust::String> history() const;
  void undo(bool told, bool between);
  void redo();
  rust::Vec<float> drawn_colours() const;
  rust::Vec<rust::String> texts() const;
  rust::Vec<double> drawn() const;

private:
  std::unique_ptr<EffectImpl> impl;
};

std::unique_ptr<Effect> new_effect(rust::Str id, rust::Str context);
void open(rust::Str folder);
void close();
rust::Vec<rust::String> plugins();
rust::Vec<rust::String> contexts(rust::Str id);
void configure(const Settings &settings);
rust::Vec<rust::String> take_log();
rust::Vec<rust::String> take_messages();
int live_images();
double furthest_progress();

} // namespace rototoon_host
