// Makes the parameters that a plugin describes.

#include "params.h"

namespace rototoon_host {

ofx::Param::Instance *new_param(ofx::Param::Descriptor &descriptor, ofx::Param::SetInstance *set) {
  const std::string &type = descriptor.getType();
  if (type == kOfxParamTypeInteger) return new IntegerParam(descriptor, set);
  if (type == kOfxParamTypeDouble) return new DoubleParam(descriptor, set);
  if (type == kOfxParamTypeBoolean) return new BooleanParam(descriptor, set);
  if (type == kOfxParamTypeChoice) return new ChoiceParam(descriptor, set);
  if (type == kOfxParamTypeDouble2D) return new PairParam(descriptor, set);
  if (type == kOfxParamTypeRGB) return new ShadeParam(descriptor, set);
  if (type == kOfxParamTypeRGBA) return new ColourParam(descriptor, set);
  if (type == kOfxParamTypeString) return new TextParam(descriptor, set);
  if (type == kOfxParamTypePushButton) return new ofx::Param::PushbuttonInstance(descriptor, set);
  if (type == kOfxParamTypeGroup) return new ofx::Param::GroupInstance(descriptor, set);
  if (type == kOfxParamTypePage) return new ofx::Param::PageInstance(descriptor, set);
  return nullptr;
}

} // namespace rototoon_host
