/* How a call of a kernel ends early: kernels ask from time to time whether they shall, and raise an exception.

   A call has the thread to itself, so whom to ask is a variable of the thread: kernels that run beside it go on. */

#include <signal.h>
#include <stdint.h>
#include <stddef.h>

/* Instead of a kernel's status: it was stopped. */
#define STOPPED (-130)

typedef int32_t kernel(int64_t *slots, double *the_same);

/* What ends the call of this thread as soon as it is not zero; NULL: nothing does. */
static _Thread_local const volatile int64_t *stop = NULL;

/* What kernels ask, see cagepose.kernels.native.interrupt. */
int32_t cagepose_is_stopped(void) { return stop != NULL && *stop != 0; }

/* Call a kernel until it ends or *flag is not zero; return its status, or STOPPED. */
int32_t cagepose_call_until(const volatile int64_t *flag, kernel *called, int64_t *slots) {
    stop = flag;
    int32_t status = called(slots, (double *)slots);
    stop = NULL;
    return status != 0 && *flag != 0 ? STOPPED : status;
}

#ifdef _WIN32

int32_t cagepose_call_until_interrupt(kernel *called, int64_t *slots) { return called(slots, (double *)slots); }

#else

static volatile int64_t interrupted;
static struct sigaction before;

static void note_interrupt(int number, siginfo_t *info, void *context) {
    interrupted = 1;
    if (before.sa_flags & SA_SIGINFO) before.sa_sigaction(number, info, context);
    else if (before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN) before.sa_handler(number);
}

/* Call a kernel from the main thread until it ends or Ctrl-C is pressed. Python hears that only after the call: its own
   handler, which is called too, leaves a note for the interpreter. It alone handles SIGINT before and after. */
int32_t cagepose_call_until_interrupt(kernel *called, int64_t *slots) {
    struct sigaction during = {.sa_sigaction = note_interrupt, .sa_flags = SA_SIGINFO | SA_ONSTACK};
    interrupted = 0;
    sigaction(SIGINT, &during, &before);
    int32_t status = cagepose_call_until(&interrupted, called, slots);
    sigaction(SIGINT, &before, NULL);
    return status;
}

#endif
