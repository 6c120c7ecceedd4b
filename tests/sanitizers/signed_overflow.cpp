#include <limits>

// Overflows a signed sum; UndefinedBehaviorSanitizer must end the program with a non-zero exit
// code. Without a sanitizer it ends with 0. `argc` keeps the compiler from knowing the sum.
int main(int argc, char**) {
  volatile int sum = std::numeric_limits<int>::max() - 1 + argc + argc;
  static_cast<void>(sum);
  return 0;
}
