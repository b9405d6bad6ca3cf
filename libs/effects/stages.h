#pragma once

#include "core/geometry.h"

/// The stages of the forward model at which an effect can act: each is a quantity on its way from the true
/// state to what a sensor reads. libs/sensors calls applyEffects() at each of them.
namespace fathom {

enum class Sensor { ins, dvl, depth };

/// Where the sensor truly sits: starts as the nominal mounting.
template <class T, Sensor S>
struct Mounting {
  Matrix3<T> R_robot_sensor = Matrix3<T>::Identity();
  Vector3<T> position_robot = Vector3<T>::Zero();  ///< m
};

/// When the reading was truly valid, against its time stamp: starts at zero, negative is earlier.
template <class T, Sensor S>
struct ValidityOffset {
  T seconds = T(0);
};

/// A DVL's velocity over ground, sensor frame, m/s.
template <class T>
struct DvlVelocity {
  Vector3<T> velocity_dvl = Vector3<T>::Zero();
};

/// Gyro reading, INS frame, rad/s.
template <class T>
struct GyroReading {
  Vector3<T> angular_velocity_ins = Vector3<T>::Zero();
};

/// Accelerometer reading, INS frame, m/s² (specific force).
template <class T>
struct AccelerometerReading {
  Vector3<T> specific_force_ins = Vector3<T>::Zero();
};

/// Absolute pressure at the sensor, Pa.
template <class T>
struct PressureReading {
  T pressure_pa = T(0);
};

/// One pixel's light on its way from the scene to the camera. A depth is optical: attenuation times way, one
/// a colour channel (red, green, blue). Both start as the base model has them, attenuation times z.
template <class T>
struct WaterRay {
  T z_m = T(0);                                  ///< way along the optical axis
  T range_m = T(0);                              ///< way along the line of sight
  Vector3<T> signal_depth = Vector3<T>::Zero();  ///< through which the scene's light comes
  Vector3<T> veil_depth = Vector3<T>::Zero();    ///< which builds up the veil
};

/// How one pixel answers to the light that reaches it: DN = full scale * (gain * radiance) ^ exponent. Starts
/// as the vehicle file has it, with a gain of 1.
template <class T>
struct PixelResponse {
  T image_radius = T(0);  ///< tangent of the line of sight's angle to the optical axis
  T gain = T(1);
  T exponent = T(1);
};

}  // namespace fathom
