// The host itself: its properties, suites and threads.
#pragma once

#include "instance.h"

#include <memory>
#include <mutex>
#include <string>

namespace rototoon_host {

class TestHost : public Recording<fx::Host> {
public:
  TestHost();
  void configure(const Settings &settings);
  const void *fetchSuite(const char *name, int version) override;
  fx::Instance *newInstance(void *, fx::ImageEffectPlugin *plugin, fx::Descriptor &descriptor,
                            const std::string &context) override;
  fx::Descriptor *makeDescriptor(fx::ImageEffectPlugin *plugin) override;
  fx::Descriptor *makeDescriptor(const fx::Descriptor &root, fx::ImageEffectPlugin *plugin) override;
  fx::Descriptor *makeDescriptor(const std::string &path, fx::ImageEffectPlugin *plugin) override;

  OfxStatus multiThread(OfxThreadFunctionV1 function, unsigned int n, void *argument) override;
  OfxStatus multiThreadNumCPUS(unsigned int *n) const override { return *n = controls().cpus, kOfxStatOK; }
  OfxStatus multiThreadIndex(unsigned int *index) const override { return *index = index_, kOfxStatOK; }
  int multiThreadIsSpawnedThread() const override { return spawned_; }
  OfxStatus mutexCreate(OfxMutexHandle *mutex, int) override;
  OfxStatus mutexDestroy(const OfxMutexHandle m) override { return delete held(m), kOfxStatOK; }
  OfxStatus mutexLock(const OfxMutexHandle m) override { return held(m)->lock(), kOfxStatOK; }
  OfxStatus mutexUnLock(const OfxMutexHandle m) override { return held(m)->unlock(), kOfxStatOK; }
  OfxStatus mutexTryLock(const OfxMutexHandle m) override { return held(m)->try_lock() ? kOfxStatOK : kOfxStatFailed; }

private:
  // Sets one of Natron's properties. Other hosts have none of them.
  void natron(const char *name, bool value);
  static std::recursive_mutex *held(OfxMutexHandle m) { return reinterpret_cast<std::recursive_mutex *>(m); }
  static thread_local bool spawned_;
  static thread_local unsigned index_;
};

TestHost &host();

// The plugins that the host has found. Null while no folder is open.
std::unique_ptr<fx::PluginCache> &cache();

} // namespace rototoon_host
