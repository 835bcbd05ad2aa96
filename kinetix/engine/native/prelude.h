// Macros and functions of the generated C++. PROCESSOR: one lane does all, to test without a GPU.
#ifdef PROCESSOR
#include <math.h>
#define ANY static inline
#define NOT_A_NUMBER NAN
#define INFINITE INFINITY
#ifdef BACKWARDS
#define LANES(i, n) for (int i = (n)-1; i >= 0; i--)
#else
#define LANES(i, n) for (int i = 0; i < (n); i++)
#endif
#define TURNS
#define ONCE
#define SYNC
#define ALL_SUM(x) (x)
#define ALL_MAX(x) (x)
#define ALL_MIN(x) (x)
#define ALL_OR(x) (x)
#define ALL_AND(x) (x)
#define TABLE(type, name, size) static const type name[size] =
#else
#define ANY static __device__ __forceinline__
#define NOT_A_NUMBER __int_as_float(0x7fc00000)
#define INFINITE __int_as_float(0x7f800000)
// Written once, not unrolled: fetching instructions is what takes the time.
#define LANES(i, n) _Pragma("unroll 1") for (int i = lane; i < (n); i += LANE_COUNT)
#define TURNS _Pragma("unroll 1")
#define ONCE if (lane == 0)
#define SYNC __syncwarp(lanes);
#define ALL_SUM(x) all_lanes<Sum>(x, lanes)
#define ALL_MAX(x) all_lanes<Largest>(x, lanes)
#define ALL_MIN(x) all_lanes<Smallest>(x, lanes)
#define ALL_OR(x) bool(__any_sync(lanes, x))
#define ALL_AND(x) bool(__all_sync(lanes, x))
#define TABLE(type, name, size) static __constant__ const type name[size] =
#endif
#define ARRAY(type, name, place) type* const name = (type*)(place);

// Not-a-number wins.
#if defined(PROCESSOR) || __CUDA_ARCH__ < 800
ANY float larger(float a, float b) { return a > b || a != a ? a : b; }
ANY float smaller(float a, float b) { return a < b || a != a ? a : b; }
#else
ANY float larger(float a, float b) {
  float c;
  asm("max.NaN.f32 %0, %1, %2;" : "=f"(c) : "f"(a), "f"(b));
  return c;
}
ANY float smaller(float a, float b) {
  float c;
  asm("min.NaN.f32 %0, %1, %2;" : "=f"(c) : "f"(a), "f"(b));
  return c;
}
#endif
ANY int larger(int a, int b) { return a > b ? a : b; }
ANY int smaller(int a, int b) { return a < b ? a : b; }
ANY unsigned larger(unsigned a, unsigned b) { return a > b ? a : b; }
ANY unsigned smaller(unsigned a, unsigned b) { return a < b ? a : b; }

// Out of line: what is long would be fetched wherever it stands.
#ifdef PROCESSOR
#define FUNCTION static
#else
#define FUNCTION static __device__ __noinline__
#endif
FUNCTION float sine(float a) { return sinf(a); }
FUNCTION float cosine(float a) { return cosf(a); }
FUNCTION float tangent(float a) { return tanf(a); }
FUNCTION float hyperbolic_tangent(float a) { return tanhf(a); }
FUNCTION float angle_of(float y, float x) { return atan2f(y, x); }

ANY int clipped(int place, int most) { return place < 0 ? 0 : place > most ? most : place; }
ANY float magnitude(float a) { return fabsf(a); }
ANY int magnitude(int a) { return a < 0 ? -a : a; }
ANY float sign_of(float a) { return a > 0 ? 1.f : a < 0 ? -1.f : a; }
ANY int sign_of(int a) { return (a > 0) - (a < 0); }
ANY bool is_finite(float a) { return fabsf(a) < INFINITE; }
ANY int quotient(int a, int b) { return b ? a / b : -1; }
ANY unsigned quotient(unsigned a, unsigned b) { return b ? a / b : ~0u; }
ANY int remainder_of(int a, int b) { return b ? a % b : a; }
ANY unsigned remainder_of(unsigned a, unsigned b) { return b ? a % b : a; }
ANY int int_of(float a) {
  return a != a ? 0 : a >= 2147483648.f ? 2147483647 : a < -2147483648.f ? -2147483647 - 1 : (int)a;
}
ANY unsigned unsigned_of(float a) { return !(a > 0) ? 0 : a >= 4294967296.f ? ~0u : (unsigned)a; }
ANY signed char signed_char_of(float a) {
  return a != a ? 0 : a > 127 ? 127 : a < -128 ? -128 : (signed char)a;
}
ANY unsigned char unsigned_char_of(float a) {
  return !(a > 0) ? 0 : a > 255 ? 255 : (unsigned char)a;
}
template <int n, class T>
ANY T power(T a) {
  if (n == 0) return 1;
  if (n == 1) return a;
  T half = power<n / 2>(a);
  return n % 2 ? half * half * a : half * half;
}

#ifndef PROCESSOR
struct Sum {
  template <class T> ANY T of(T a, T b) { return a + b; }
};
struct Largest {
  template <class T> ANY T of(T a, T b) { return larger(a, b); }
};
struct Smallest {
  template <class T> ANY T of(T a, T b) { return smaller(a, b); }
};
template <class Operation, class T>
ANY T all_lanes(T own, unsigned lanes) {
  for (int other = LANE_COUNT / 2; other; other /= 2)
    own = Operation::of(own, __shfl_xor_sync(lanes, own, other));
  return own;
}
#endif
