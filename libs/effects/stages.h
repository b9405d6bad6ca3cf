#pragma once

#include "core/beam_geometry.h"
#include "core/camera_model.h"
#include "core/face_shape.h"
#include "core/geometry.h"

/// The stages of the forward model at which an effect can act: each is a quantity on its way from the true
/// state to what a sensor reads. libs/sensors calls applyEffects() at each of them. What starts as the
/// nominal model has it is the effects' to change; members called context are theirs to look at.
namespace fathom {

// Of any instrument, named by its type (libs/sensors).

/// Where the instrument truly sits: starts as the nominal mounting.
template <class T, class Instrument>
struct Mounting {
  Matrix3<T> R_robot_sensor = Matrix3<T>::Identity();
  Vector3<T> position_robot = Vector3<T>::Zero();  ///< m
};

/// When a measurement was truly valid, against its time stamp: starts at zero, negative is earlier. Where an
/// effect acts at this one, it acts on all instruments.
template <class T>
struct Validity {
  T seconds = T(0);
  double t_s = 0;   ///< context: the stamp, since the recording's first entry
  int sensor = -1;  ///< context: the instrument's place in kSensorKinds
};
/// The same of one kind of instrument.
template <class T, class Instrument>
struct ValidityOffset : Validity<T> {};
template <class Stage>
inline constexpr bool kIsValidityOffset = false;
template <class T>
inline constexpr bool kIsValidityOffset<Validity<T>> = true;
template <class T, class Instrument>
inline constexpr bool kIsValidityOffset<ValidityOffset<T, Instrument>> = true;

// Navigation.

/// A DVL's velocity over ground, sensor frame, m/s.
template <class T>
struct DvlVelocity {
  Vector3<T> velocity_dvl = Vector3<T>::Zero();
  Matrix3<T> R_odom_dvl = Matrix3<T>::Identity();  ///< context
  BeamGeometry beams{};                            ///< context; without any, none is off by itself
};

/// Gyro reading, INS frame, rad/s.
template <class T>
struct GyroReading {
  Vector3<T> angular_velocity_ins = Vector3<T>::Zero();
  Matrix3<T> R_odom_ins = Matrix3<T>::Identity();  ///< context
};

/// Accelerometer reading, INS frame, m/s² (specific force).
template <class T>
struct AccelerometerReading {
  Vector3<T> specific_force_ins = Vector3<T>::Zero();
};

/// The water above the depth sensor: starts as the vehicle file has it.
template <class T>
struct SeaWater {
  T density_kg_m3 = T(0);
};

/// Absolute pressure at the sensor, Pa.
template <class T>
struct PressureReading {
  T pressure_pa = T(0);
};

/// Heading that a compass reads, about odom's z axis, rad, from wherever it is measured.
template <class T>
struct HeadingReading {
  T heading_rad = T(0);
  Vector3<T> position_odom = Vector3<T>::Zero();  ///< context: of the robot
};

// Marker geometry.

/// A marker on its panel: starts as the panel map has it.
template <class T>
struct MarkerPlacement {
  int id = 0;                                      ///< context
  T size_m = T(0);                                 ///< side of the border square
  Vector3<T> position_panel = Vector3<T>::Zero();  ///< of its centre, m
  Matrix3<T> R_panel_marker = Matrix3<T>::Identity();
};

/// A panel in the world: starts as the panel map has it.
template <class T>
struct PanelPlacement {
  double t_s = 0;  ///< context: since the recording's first entry
  Vector3<T> position_odom = Vector3<T>::Zero();
  Matrix3<T> R_odom_panel = Matrix3<T>::Identity();
  Vector3d first_odom = Vector3d::Zero();  ///< context: where the map has the first panel's origin
};

/// What a marker's print is covered with: starts clean.
template <class T>
struct MarkerCover {
  int id = 0;                              ///< context
  T share = T(0);                          ///< of its area, evenly
  Vector3<T> albedo = Vector3<T>::Zero();  ///< of what covers it; red, green, blue
};

// FaceShape (core/face_shape.h): how its face differs from that of the map.

/// Refractive index of sea water in green light (Quan & Fry 1995); fresh 1.334.
inline constexpr double kWaterIndex = 1.34;

/// A flat port before the camera: parallel layers of air and glass, and water behind. See
/// imaging/flat_port.h.
template <class T>
struct FlatPort {
  bool present = false;  ///< false: straight lines of sight
  T distance_m = T(0);   ///< from the camera's centre to the glass, along the port's normal
  T glass_m = T(0);      ///< thickness
  T tilt_x_rad = T(0);   ///< the normal is Exp(tilt_x, tilt_y, 0) z, camera frame
  T tilt_y_rad = T(0);
  T index_error = T(0);  ///< water's refractive index over that which the intrinsics contain, minus 1
  T slab_m = T(0);       ///< thickness of water behind the glass, where what follows is what the camera is in
  T calibration_per_m = T(0);  ///< 1 over the range at which the intrinsics were found, through this port
  T window_m = T(0);  ///< way to it through what the intrinsics are for, such as air before an aquarium
};

inline constexpr double kUsualDome_m = 0.075, kUsualDomeGlass_m = 0.005;  ///< outer radius, thickness

/// A dome before the camera: air inside, a shell of glass, water behind. See imaging/dome_port.h.
template <class T>
struct DomePort {
  bool present = false;                      ///< false: straight lines of sight
  Vector3<T> centre_m = Vector3<T>::Zero();  ///< of its spheres, camera frame: the camera's own is zero
  T log_radius = T(0);                       ///< ln of the outer radius over kUsualDome_m
  T glass_m = T(0);                          ///< thickness
};

/// The water's flat surface under a camera that looks down through it from the air. See
/// imaging/water_surface.h.
template <class T>
struct WaterSurface {
  bool present = false;  ///< false: straight lines of sight
  T water_m = T(0);      ///< above where the map has the first panel's origin, along odom's z
  T tilt_x_rad = T(0);   ///< the surface's normal is Exp(tilt_x, tilt_y, 0) z, odom
  T tilt_y_rad = T(0);
  T log_index = T(0);  ///< ln of the water's refractive index over kWaterIndex
};

/// Pinhole and plumb-bob lens, as in CameraModel: starts as the nominal camera.
template <class T>
struct Intrinsics {
  T fx_px = T(1), fy_px = T(1), cx_px = T(0), cy_px = T(0);
  T k1 = T(0), k2 = T(0), p1 = T(0), p2 = T(0), k3 = T(0), k4{T(0)}, k5{T(0)}, k6{T(0)};
  LensModel lens{};
};

/// When the image's rows are read: row v at the first one's time + readout_s v / height.
template <class T>
struct Shutter {
  bool rolling = false;  ///< false: all rows at once
  T readout_s = T(0);
};

/// How far white grows over black at each edge in the image, as a detector sees it; starts with none.
template <class T>
struct EdgeSpread {
  T white_px = T(0);
};

// Image.

/// The light that falls on what is seen.
template <class T>
struct SceneLight {
  /// Context: where on its panel that is, from the middle of the face, right and up; zero where it is of
  /// none.
  Eigen::Vector2d at_panel_m = Eigen::Vector2d::Zero();
  T daylight = T(1);   ///< in units of the environment's ambient light
  T lamps = T(0);      ///< irradiance of each of the vehicle's on its axis at 1 m, see imaging/lamps.h
  T scattered = T(1);  ///< of it by the water, over what of daylight builds up the veil
  T asymmetry = T(0);  ///< by Henyey and Greenstein: mean cosine of the angle by which it is scattered
};

/// Where a line of sight runs: in odom axes, from where the map has the first panel.
template <class T>
struct SightInScene {
  Vector3<T> camera_m = Vector3<T>::Zero(), direction = Vector3<T>::Zero();  ///< unit length; zero: unknown
};

/// One pixel's light on its way from the scene to the camera. A depth is optical: attenuation times way, one
/// a colour channel (red, green, blue). Both start as the base model has them, attenuation times z.
template <class T>
struct WaterRay {
  double t_s = 0;                                ///< context: since the recording's first entry
  T z_m = T(0);                                  ///< way along the optical axis
  T range_m = T(0);                              ///< way along the line of sight
  Vector3<T> signal_depth = Vector3<T>::Zero();  ///< through which the scene's light comes
  Vector3<T> veil_depth = Vector3<T>::Zero();    ///< which builds up the veil
  Vector3<T> bends = Vector3<T>::Zero();  ///< of signal_depth, what only bends: see imaging/forward_scatter.h
  SightInScene<T> sight{};                ///< context
};

/// Flakes between the camera and the scene, strewn evenly. See imaging/marine_snow.h.
template <class T>
struct SuspendedParticles {
  T per_m3 = T(0);
};

/// What is right before the camera, where a line of sight goes: starts with nothing.
template <class T>
struct ViewCover {
  /// Context: of a pixel or a patch, shares of the image's width and height; what it extends over, standard
  /// deviations.
  Vector2d place = Vector2d::Zero(), spread = Vector2d::Zero();
  T share = T(0);  ///< of the light that comes from there instead
  T radiance = T(0);
};

/// Of the light that comes into the camera, what lens and port strew evenly over the image.
template <class T>
struct StrayLight {
  T share = T(0);
};

/// How one pixel answers to the light that reaches it, each colour (red, green, blue) for itself: DN = full
/// scale * (curve(gain * radiance) + offset), the curve of ResponseCurve. Starts with a gain of 1 and no
/// offset.
template <class T>
struct PixelResponse {
  T image_radius = T(0);  ///< context: tangent of the line of sight's angle to the optical axis
  Eigen::Vector2d image_tangent = Eigen::Vector2d::Zero();  ///< context: the same to the right and down
  Vector3<T> gain = Vector3<T>::Ones();
  Vector3<T> offset = Vector3<T>::Zero();  ///< share of full scale
};

/// By which curve all pixels answer: r + bend r (1 - r), r = light ^ exponent, light 1 being full scale.
/// Starts as the vehicle file has it, without a bend. A stage of its own because it moves edges too, where a
/// detector sees them (imaging/detected_corners.h).
template <class T>
struct ResponseCurve {
  T exponent = T(1);
  Vector3<T> bend = Vector3<T>::Zero();
};

/// Of what the camera hands out, the share in which a pixel has the two colours that it does not measure
/// from its neighbours (bilinear, Bayer pattern): 0 as if it measured all three, 1 as a usual camera's.
template <class T>
struct ColourInterpolation {
  T interpolated = T(0);
};

/// How images were coded before they were recorded. See imaging/image_texture.h.
template <class T>
struct ImageCoding : ColourInterpolation<T> {
  /// To multiples of which a block's mean brightness times 8 was rounded, in an image's numbers of eight
  /// bits; all that is rounded beside it goes with it. 0: not compressed.
  T quantum_dn = T(0);
};

/// How much softer the lens makes the image than the vehicle file's does, and how much harder the camera's
/// processing makes it again: the second moment of what each spreads a point to, alike to all sides.
template <class T>
struct ImageSoftness : ColourInterpolation<T> {
  T lens_px2 = T(0);
  T sharpened_px2 =
      T(0);  ///< less than there is of both; what is darker around a bright line counts negative
};

/// For how long the shutter is open, squared, about the time at which the image is valid: what moves
/// meanwhile is smeared along its way. The base model's is what the vehicle file states.
template <class T>
struct ExposureTime {
  T squared_s2 = T(0);
};

/// Stages that are the same for each instrument that looks at them.
template <class Stage>
inline constexpr bool kIsOfWorld = false;
template <class T>
inline constexpr bool kIsOfWorld<SeaWater<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<MarkerPlacement<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<PanelPlacement<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<MarkerCover<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<FaceShape<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<WaterSurface<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<SceneLight<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<WaterRay<T>> = true;
template <class T>
inline constexpr bool kIsOfWorld<SuspendedParticles<T>> = true;

}  // namespace fathom
