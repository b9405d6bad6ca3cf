#include "sensors/channel_model.h"

#include "core/random.h"
#include "effects/catalogue.h"

namespace fathom {
namespace {

template <class C, class T>
Prediction<T> predictionOf(const Inputs<T>& in, const Vehicle& vehicle, const Observation& seen) {
  return C::predict(in, sheetOf<C>(vehicle, seen.instance), seen);
}

template <class C>
ChannelModel makeModel() {
  ChannelModel model{predictionOf<C, double>,
                     predictionOf<C, SensorJet>,
                     predictionOf<C, ShortJet>,
                     [](const EffectParameters<double>& effects, double t_s) {
                       return validityOffset<typename C::Instrument>(effects, t_s);
                     },
                     [](const EffectParameters<SensorJet>& effects, double t_s) {
                       return validityOffset<typename C::Instrument>(effects, t_s);
                     },
                     effectsAt<double, ValidityOffset<double, typename C::Instrument>>()};
  if constexpr (requires { &C::drift; }) {
    model.drift_effect = kEffectIndex<typename C::DriftEffect>;
    model.drift = [](const Vehicle& vehicle, const Instance& instance) {
      return C::drift(sheetOf<C>(vehicle, instance));
    };
  }
  Inputs<double> in = exampleInputs();
  in.effects.asked = &model.effects;
  model.predict(in, Vehicle{}, exampleObservation());
  return model;
}

template <class... Channels>
std::array<ChannelModel, sizeof...(Channels)> makeModels(std::tuple<Channels...>*) {
  return {makeModel<Channels>()...};
}

}  // namespace

const ChannelModel& modelOf(Channel channel) {
  static const auto models = makeModels(static_cast<InstrumentChannels*>(nullptr));
  return models.at(indexOf(channel));
}

Inputs<double> exampleInputs() {
  Random random(1);
  Inputs<double> in;
  in.state = {random.normal3(), expSO3<double>(random.normal3()),
              random.normal3(), random.normal3(),
              random.normal3(), random.normal3()};
  in.world.sea_floor_z_m = -10;
  in.effects.on.set();
  for (std::size_t s = 0; s < in.effects.values.size(); ++s)
    in.effects.values[s] = parameterOf(s).prior_sigma * random.uniform(0.1, 0.5);
  return in;
}

Observation exampleObservation() {
  Random random(2);
  Observation seen{
      Vector3d::Zero(), Matrix3d::Identity(), {expSO3<double>(random.normal3()), random.normal3()}};
  seen.about = expSO3<double>(random.normal3());
  return seen;
}

}  // namespace fathom
