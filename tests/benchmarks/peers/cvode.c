/* CVODE of SUNDIALS (BDF, dense, difference Jacobian) for a right-hand side that comes as a function pointer. */
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

typedef void (*Rate)(double time, const double* state, double* change, const double* parameters);

typedef struct {
  Rate rate;
  const double* parameters;
} Equations;

typedef struct {
  SUNContext context;
  N_Vector state;
  SUNMatrix matrix;
  SUNLinearSolver linear;
  void* memory;
} Solver;

static int evaluate(double time, N_Vector state, N_Vector change, void* given) {
  const Equations* equations = given;
  equations->rate(time, NV_DATA_S(state), NV_DATA_S(change), equations->parameters);
  return 0;
}

static Solver begin(Equations* equations, int size, double tolerance, double start) {
  Solver s;
  SUNContext_Create(0, &s.context);
  s.state = N_VNew_Serial(size, s.context);
  N_VConst(0.0, s.state);
  s.memory = CVodeCreate(CV_BDF, s.context);
  CVodeInit(s.memory, evaluate, start, s.state);
  CVodeSStolerances(s.memory, tolerance, tolerance);
  CVodeSetUserData(s.memory, equations);
  CVodeSetMaxNumSteps(s.memory, 10000000);
  s.matrix = SUNDenseMatrix(size, size, s.context);
  s.linear = SUNLinSol_Dense(s.state, s.matrix, s.context);
  CVodeSetLinearSolver(s.memory, s.linear, s.matrix);
  return s;
}

static void end(Solver* s) {
  CVodeFree(&s->memory);
  SUNLinSolFree(s->linear);
  SUNMatDestroy(s->matrix);
  N_VDestroy(s->state);
  SUNContext_Free(&s->context);
}

/* Writes the state at each instant into a row of `found`, from zero at the first. Gives 0, or what CVODE says of its
   failure. States are counted in their own units, so that one `tolerance`, relative and absolute, serves all. */
int integrate(Rate rate, const double* parameters, int size, double tolerance, const double* time, int samples,
              double* found) {
  Equations equations = {rate, parameters};
  Solver solver = begin(&equations, size, tolerance, time[0]);
  int status = 0;
  double reached = time[0];
  for (int k = 0; k < samples && status >= 0; ++k) {
    if (k > 0) status = CVode(solver.memory, time[k], solver.state, &reached, CV_NORMAL);
    for (int i = 0; i < size; ++i) found[k * size + i] = NV_DATA_S(solver.state)[i];
  }
  end(&solver);
  return status < 0 ? status : 0;
}
