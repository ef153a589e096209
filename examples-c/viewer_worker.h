/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_worker.h -- a thread that does one task at a time, so that the window answers while one takes long. Knows
 * neither frames nor windows. */
#ifndef EXAMPLES_VIEWER_WORKER_H
#define EXAMPLES_VIEWER_WORKER_H

typedef struct WorkerSystem WorkerSystem; /* the system's thread, and what it waits for */

/* All zero before it is started. */
typedef struct Worker {
    WorkerSystem *system;           /* NULL: not started */
    void        (*on_done)(void);   /* called on the thread after each task, or NULL */
    void        (*task)(void *);
    void         *argument;
    int           busy;             /* a task was begun, and its end not taken */
} Worker;

/* 1, or 0 after a message. */
int worker_start(Worker *worker, void (*on_done)(void));

/* Begins a task. None may be under way; what it reads and writes is the thread's until its end is taken. */
void worker_begin(Worker *worker, void (*task)(void *), void *argument);

/* Takes the end of the task that is under way, if it is there, or waits for it. 1: this task is done now. */
int worker_take(Worker *worker, int wait);

/* Waits for a task that is under way, and ends the thread, if there is one. */
void worker_end(Worker *worker);

#endif
