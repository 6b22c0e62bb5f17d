// The functions of the host that Rust calls.

#include "rototoon-ofx-host/src/host.h"
#include "rototoon-ofx-host/src/bridge.rs.h"
#include "test_host.h"

namespace rototoon_host {

namespace {

rust::Vec<rust::String> moved(std::vector<std::string> &from) {
  rust::Vec<rust::String> to;
  std::lock_guard<std::mutex> lock(controls().mutex);
  for (const std::string &line : from) to.push_back(rust::String::lossy(line));
  from.clear();
  return to;
}

} // namespace

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

} // namespace rototoon_host
