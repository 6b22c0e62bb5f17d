// The headers of OpenFX and of the HostSupport library. Not every one includes what it needs, so their order counts.
#pragma once

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

namespace rototoon_host {
namespace ofx = OFX::Host;
namespace fx = OFX::Host::ImageEffect;
} // namespace rototoon_host
