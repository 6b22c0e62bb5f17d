// The host itself: its properties, suites and threads.

#include "test_host.h"
#include "draw.h"

#include <cstring>
#include <thread>

namespace rototoon_host {

namespace {

// Natron's developers report of Resolve 14 that one function is null, and the other one an address of nothing.
const OfxMessageSuiteV2 *null_messages() {
  static OfxMessageSuiteV2 suite = {};
  suite.clearPersistentMessage = reinterpret_cast<OfxStatus (*)(void *)>(uintptr_t(8));
  return &suite;
}

} // namespace

thread_local bool TestHost::spawned_ = false;
thread_local unsigned TestHost::index_ = 0;

TestHost::TestHost() {
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

void TestHost::configure(const Settings &settings) {
  _properties.setStringProperty(kOfxPropName, std::string(settings.name));
  _properties.setStringProperty(kOfxPropLabel, std::string(settings.name));
  _properties.setIntProperty(kOfxImageEffectPropSupportsMultiResolution, settings.multi_resolution);
  _properties.setIntProperty(kOfxImageEffectPropSupportsTiles, settings.tiles);
  _properties.setIntProperty(kOfxImageEffectPropTemporalClipAccess, settings.temporal);
  _properties.setIntProperty(kOfxParamHostPropSupportsChoiceAnimation, settings.choice_keys);
  natron("NatronOfxParamHostPropSupportsDynamicChoices", settings.menus);
  natron("NatronOfxHostIsNatron", settings.natron);
}

const void *TestHost::fetchSuite(const char *name, int version) {
  for (const std::string &missing : controls().missing_suites)
    if (missing == name || missing == std::string(name) + "/" + std::to_string(version)) return nullptr;
  if (strcmp(name, kOfxDrawSuite) == 0) return version == 1 ? draw_suite() : nullptr;
  if (strcmp(name, kOfxMessageSuite) == 0 && version == 2 && controls().null_messages) return null_messages();
  return fx::Host::fetchSuite(name, version);
}

fx::Instance *TestHost::newInstance(void *, fx::ImageEffectPlugin *plugin, fx::Descriptor &descriptor,
                                    const std::string &context) {
  return new TestEffect(plugin, descriptor, context);
}

fx::Descriptor *TestHost::makeDescriptor(fx::ImageEffectPlugin *plugin) {
  fx::Descriptor *descriptor = new fx::Descriptor(plugin);
  // The library supports OpenFX 1.4, which does not have this property.
  static const ofx::Property::PropSpec newer[] = {
      {kOfxImageEffectPluginPropOverlayInteractV2, ofx::Property::ePointer, 1, false, nullptr},
      ofx::Property::propSpecEnd};
  descriptor->getProps().addProperties(newer);
  return descriptor;
}

fx::Descriptor *TestHost::makeDescriptor(const fx::Descriptor &root, fx::ImageEffectPlugin *plugin) {
  return new fx::Descriptor(root, plugin);
}

fx::Descriptor *TestHost::makeDescriptor(const std::string &path, fx::ImageEffectPlugin *plugin) {
  return new fx::Descriptor(path, plugin);
}

OfxStatus TestHost::multiThread(OfxThreadFunctionV1 function, unsigned int n, void *argument) {
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

OfxStatus TestHost::mutexCreate(OfxMutexHandle *mutex, int) {
  *mutex = reinterpret_cast<OfxMutexHandle>(new std::recursive_mutex);
  return kOfxStatOK;
}

void TestHost::natron(const char *name, bool value) {
  const ofx::Property::PropSpec specs[] = {{name, ofx::Property::eInt, 1, false, "0"}, ofx::Property::propSpecEnd};
  if (value && !_properties.fetchProperty(name)) _properties.addProperties(specs);
  if (_properties.fetchProperty(name)) _properties.setIntProperty(name, value);
}

TestHost &host() {
  log_output();
  static TestHost instance;
  return instance;
}

std::unique_ptr<fx::PluginCache> &cache() {
  static std::unique_ptr<fx::PluginCache> instance;
  return instance;
}

} // namespace rototoon_host
