/* palpate for C and C++: which shape is touched, and how far to trust the answer.
 *
 * Made by src/capi/header.sh; a test holds it to the library. What is undefined is NaN. No function throws or aborts: each that can
 * fail gives a PalpateStatus, and palpate_last_message says in words what went wrong. A handle may be used by one thread at a time.
 */

#ifndef PALPATE_H
#define PALPATE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

// What became of a call.
typedef enum PalpateStatus {
  // It was done.
  PALPATE_STATUS_OK = 0,
  // A pointer is null that must not be.
  PALPATE_STATUS_NULL = 1,
  // A number, an option or a contact is faulty.
  PALPATE_STATUS_INPUT = 2,
  // The contacts are too few, or leave a question open, so that there is no answer.
  PALPATE_STATUS_NO_ANSWER = 3,
  // A fault of the library, which the message describes.
  PALPATE_STATUS_INTERNAL = 4,
} PalpateStatus;

// Koenderink's classes, in the order of S, and the plane.
typedef enum PalpateClass {
  PALPATE_CLASS_CUP = 0,
  PALPATE_CLASS_TROUGH = 1,
  PALPATE_CLASS_RUT = 2,
  PALPATE_CLASS_SADDLE_RUT = 3,
  PALPATE_CLASS_SADDLE = 4,
  PALPATE_CLASS_SADDLE_RIDGE = 5,
  PALPATE_CLASS_RIDGE = 6,
  PALPATE_CLASS_DOME = 7,
  PALPATE_CLASS_CAP = 8,
  PALPATE_CLASS_PLANE = 9,
  // There is no other class, or none at all.
  PALPATE_CLASS_NONE = 10,
} PalpateClass;

// Kinds of surface that a recognition compares.
typedef enum PalpateKind {
  PALPATE_KIND_PLANE = 0,
  PALPATE_KIND_SPHERE = 1,
  PALPATE_KIND_CYLINDER = 2,
  PALPATE_KIND_GENERAL = 3,
  PALPATE_KIND_PARABOLOID = 4,
  PALPATE_KIND_DISPLACED = 5,
  PALPATE_KIND_QUADRIC = 6,
  PALPATE_KIND_TORUS = 7,
  PALPATE_KIND_CONE = 8,
  // The height field that was named.
  PALPATE_KIND_HEIGHT_FIELD = 9,
  // Any curve turned about an axis.
  PALPATE_KIND_REVOLUTION = 10,
  // Any curve drawn along a line.
  PALPATE_KIND_EXTRUSION = 11,
} PalpateKind;

// Contacts: places, each with or without the outward normal there.
typedef struct PalpateContacts PalpateContacts;

// A fitted height field.
typedef struct PalpateFit PalpateFit;

// A recognised surface.
typedef struct PalpateRecognition PalpateRecognition;

// A fit that grows touch by touch.
typedef struct PalpateStream PalpateStream;

// Which spline is fitted. `palpate_fit_defaults` fills it.
typedef struct PalpateFitOptions {
  // Degrees in x and y, 1 to 9.
  size_t degree[2];
  // Uniform segments in x and y.
  size_t segments[2];
  // Points of the map in x and y.
  size_t grid[2];
  // Level of the intervals, between 0 and 1.
  double level;
  // Whether the domain is `domain`; else it is the contacts' own rectangle.
  bool has_domain;
  // x0, x1, y0, y1.
  double domain[4];
  // Known standard deviation of heights; 0: both are estimated with the fit. Counts for contacts that all have normals.
  double sigma_z;
  // Known standard deviation of normals, degrees.
  double sigma_normal_deg;
} PalpateFitOptions;

// A number with its uncertainty.
typedef struct PalpateEstimate {
  // Mean over the patch.
  double mean;
  // Standard uncertainty of the mean, in all.
  double u;
  // Lower end of the interval.
  double lo;
  // Upper end of the interval.
  double hi;
} PalpateEstimate;

// What contacts show. Lengths are in their unit; NaN is what is undefined.
typedef struct PalpateShape {
  // Class of the mean S.
  enum PalpateClass class_;
  // The class from the other side, where nothing tells which side is free.
  enum PalpateClass other_class;
  // Probability of `class_`, and of `other_class` where there is one.
  double class_probability;
  // Likeliest kind of surface.
  enum PalpateKind kind;
  // Its probability.
  double kind_probability;
  // Shape index S.
  struct PalpateEstimate shape_index;
  // Curvedness R, 1/length.
  struct PalpateEstimate curvedness;
  // Radius of cap, cup, ridge and rut; its `u` is NaN.
  struct PalpateEstimate radius;
  // Level of the intervals.
  double level;
  // Contacts that were used.
  size_t contacts;
  // Contacts that do not belong to the surface and were left out.
  size_t outliers;
} PalpateShape;

// A point of a height field.
typedef struct PalpatePoint {
  // Height.
  double z;
  // Slopes dz/dx and dz/dy.
  double slopes[2];
  // Unit normal towards +z.
  double normal[3];
  // Larger principal curvature.
  double k1;
  // Smaller principal curvature.
  double k2;
  // Shape index; NaN where both curvatures vanish.
  double shape_index;
  // Curvedness.
  double curvedness;
} PalpatePoint;

// A point of a map.
typedef struct PalpateMapPoint {
  // Point of the surface.
  double position[3];
  // Outward unit normal.
  double normal[3];
  // Shape index; NaN on a plane.
  double shape_index;
  // Curvedness, 1/length.
  double curvedness;
  // Larger principal curvature.
  double k1;
  // Smaller principal curvature.
  double k2;
  // Whether contacts support the surface here.
  bool supported;
} PalpateMapPoint;

// What may be said to a recognition. `palpate_recognise_defaults` fills it.
typedef struct PalpateRecogniseOptions {
  // Level of the intervals, between 0 and 1.
  double level;
  // Points of the map each way.
  size_t grid[2];
  // Seed of the posterior's draws.
  uint64_t seed;
  // Whether the sensor stood at `viewpoint`, which lies on the free side.
  bool has_viewpoint;
  // Where it stood.
  double viewpoint[3];
  // Known standard deviation of the errors in x and in y; 0 where they err alike in all directions.
  double sigma_xy;
} PalpateRecogniseOptions;

// The plan of a stream. `palpate_stream_defaults` fills all but the domain.
typedef struct PalpateStreamOptions {
  // Where touches may lie: x0, x1, y0, y1.
  double domain[4];
  // Degrees in x and y, 1 to 9.
  size_t degree[2];
  // Uniform segments in x and y.
  size_t segments[2];
  // Standard deviations of heights and of slopes in x and in y.
  double sigma[3];
  // Points in x and y over which S and R are averaged.
  size_t grid[2];
  // Part of the domain's sides that is left out at each edge of the grid, below 1/2.
  double inset;
  // Only the last so many touches count; 0: all of them.
  size_t window;
  // Share that a touch counts of what it counted before, with every touch after it; 1: nothing fades. Not beside a window.
  double decay;
} PalpateStreamOptions;

// S and R after the touches so far.
typedef struct PalpateStreamShape {
  // Shape index S; its interval is NaN, because noise alone is known.
  struct PalpateEstimate shape_index;
  // Curvedness R, 1/length.
  struct PalpateEstimate curvedness;
  // Touches that count.
  size_t contacts;
} PalpateStreamShape;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The words of the last call on this thread that was refused, in UTF-8; empty where none was. They stay until the next call
// that is refused.
const char *palpate_last_message(void);

// The library's version, as `0.2.0`.
const char *palpate_version(void);

// New contacts, of which there are none yet. Free them by `palpate_contacts_free`.
//
// # Safety
// `contacts` can be written to.
enum PalpateStatus palpate_contacts_new(struct PalpateContacts **contacts);

// Frees contacts; null is nothing.
//
// # Safety
// `contacts` is null or a handle that was not freed before.
void palpate_contacts_free(struct PalpateContacts *contacts);

// Adds a place.
//
// # Safety
// `contacts` is null or a living handle that no other thread uses meanwhile.
enum PalpateStatus palpate_contacts_add(struct PalpateContacts *contacts, double x, double y, double z);

// Adds a place with the outward normal there, of any length but zero.
//
// # Safety
// `contacts` is null or a living handle that no other thread uses meanwhile.
enum PalpateStatus palpate_contacts_add_with_normal(struct PalpateContacts *contacts,
                                                    double x,
                                                    double y,
                                                    double z,
                                                    double nx,
                                                    double ny,
                                                    double nz);

// Forgets all contacts; their memory is kept for others.
//
// # Safety
// `contacts` is null or a living handle that no other thread uses meanwhile.
enum PalpateStatus palpate_contacts_clear(struct PalpateContacts *contacts);

// Number of contacts; 0 of null.
//
// # Safety
// `contacts` is null or a living handle that no other thread changes meanwhile.
size_t palpate_contacts_count(const struct PalpateContacts *contacts);

// Fills the options with the paper's spline: degree 2, one segment.
//
// # Safety
// `options` is null or can be written to.
enum PalpateStatus palpate_fit_defaults(struct PalpateFitOptions *options);

// Fits the spline that the options name. `options` may be null: then the defaults count. Its intervals count noise alone.
// Where some contacts have no normal, those of the others are not used. Free the result by `palpate_fit_free`.
//
// # Safety
// `contacts` and `options` are null or name living values, and `fit` can be written to.
enum PalpateStatus palpate_fit(const struct PalpateContacts *contacts,
                               const struct PalpateFitOptions *options,
                               struct PalpateFit **fit);

// Frees a fit; null is nothing.
//
// # Safety
// `fit` is null or a handle that was not freed before.
void palpate_fit_free(struct PalpateFit *fit);

// What the fitted surface looks like.
//
// # Safety
// `fit` is null or a living handle, and `shape` is null or can be written to.
enum PalpateStatus palpate_fit_shape(const struct PalpateFit *fit, struct PalpateShape *shape);

// The fitted surface over a place. Outside the domain its end polynomials go on.
//
// # Safety
// `fit` is null or a living handle, and `point` is null or can be written to.
enum PalpateStatus palpate_fit_at(const struct PalpateFit *fit, double x, double y, struct PalpatePoint *point);

// The map of the surface over its grid: as many of its points as there is room for; `count` is how many there are. `points`
// may be null, to ask for the count alone.
//
// # Safety
// `fit` is null or a living handle, `points` is null or has room for `room` values, `count` can be written to.
enum PalpateStatus palpate_fit_map(const struct PalpateFit *fit,
                                   struct PalpateMapPoint *points,
                                   size_t room,
                                   size_t *count);

// Fills the options with what serves a user who says nothing.
//
// # Safety
// `options` is null or can be written to.
enum PalpateStatus palpate_recognise_defaults(struct PalpateRecogniseOptions *options);

// Recognises what the contacts show. `options` may be null: then the defaults count. Free the result by
// `palpate_recognition_free`.
//
// # Safety
// `contacts` and `options` are null or name living values, and `recognition` can be written to.
enum PalpateStatus palpate_recognise(const struct PalpateContacts *contacts,
                                     const struct PalpateRecogniseOptions *options,
                                     struct PalpateRecognition **recognition);

// Frees a recognition; null is nothing.
//
// # Safety
// `recognition` is null or a handle that was not freed before.
void palpate_recognition_free(struct PalpateRecognition *recognition);

// What was recognised.
//
// # Safety
// `recognition` is null or a living handle, and `shape` is null or can be written to.
enum PalpateStatus palpate_recognition_shape(const struct PalpateRecognition *recognition, struct PalpateShape *shape);

// The map of the surface: as many of its points as there is room for; `count` is how many there are. `points` may be null, to
// ask for the count alone.
//
// # Safety
// `recognition` is null or a living handle, `points` is null or has room for `room` values, `count` can be written to.
enum PalpateStatus palpate_recognition_map(const struct PalpateRecognition *recognition,
                                           struct PalpateMapPoint *points,
                                           size_t room,
                                           size_t *count);

// Signed distance of a place from the surface, positive on the free side.
//
// # Safety
// `recognition` is null or a living handle, and `distance` is null or can be written to.
enum PalpateStatus palpate_recognition_distance(const struct PalpateRecognition *recognition,
                                                double x,
                                                double y,
                                                double z,
                                                double *distance);

// A `PalpateClass` in one word, as in every other output.
const char *palpate_class_name(int32_t class_);

// A `PalpateKind` in words, as in every other output.
const char *palpate_kind_name(int32_t kind);

// Fills the options but for the domain, which is empty until it is named.
//
// # Safety
// `options` is null or can be written to.
enum PalpateStatus palpate_stream_defaults(struct PalpateStreamOptions *options);

// Plans a stream. Free it by `palpate_stream_free`.
//
// # Safety
// `options` is null or names a living value, and `stream` can be written to.
enum PalpateStatus palpate_stream_new(const struct PalpateStreamOptions *options, struct PalpateStream **stream);

// Frees a stream; null is nothing.
//
// # Safety
// `stream` is null or a handle that was not freed before.
void palpate_stream_free(struct PalpateStream *stream);

// Adds a touch with its slopes dz/dx and dz/dy. Asks for no memory where it succeeds; changes nothing where it fails.
//
// # Safety
// `stream` is null or a living handle that no other thread uses meanwhile.
enum PalpateStatus palpate_stream_push(struct PalpateStream *stream,
                                       double x,
                                       double y,
                                       double z,
                                       double zx,
                                       double zy);

// Adds a touch with its outward normal, of any length, with nz > 0. As `palpate_stream_push`.
//
// # Safety
// `stream` is null or a living handle that no other thread uses meanwhile.
enum PalpateStatus palpate_stream_push_with_normal(struct PalpateStream *stream,
                                                   double x,
                                                   double y,
                                                   double z,
                                                   double nx,
                                                   double ny,
                                                   double nz);

// S and R after the touches so far, with the standard uncertainties that the sds of the plan give. Asks for no memory on
// patches of one segment.
//
// # Safety
// `stream` is null or a living handle that no other thread uses meanwhile, and `shape` is null or can be written to.
enum PalpateStatus palpate_stream_shape(struct PalpateStream *stream,
                                        struct PalpateStreamShape *shape);

// Forgets all touches; the plan stays.
//
// # Safety
// `stream` is null or a living handle that no other thread uses meanwhile.
enum PalpateStatus palpate_stream_clear(struct PalpateStream *stream);

// Touches that count; 0 of null.
//
// # Safety
// `stream` is null or a living handle that no other thread changes meanwhile.
size_t palpate_stream_count(const struct PalpateStream *stream);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PALPATE_H */
