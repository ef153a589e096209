/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_worker.c -- see viewer_worker.h. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200112L /* threads */
#endif

#include "viewer_worker.h"

#include <stdio.h>
#include <stdlib.h>

/* A system has: start and end; give, for a task, which the thread waits for; is_done, which takes the task's end, or
 * waits for it. */
#ifdef _WIN32

#include <windows.h>

struct WorkerSystem {
    HANDLE thread, given, done; /* events that reset by themselves, when one has waited for them */
    int    ends;
};

static DWORD WINAPI work(void *argument) {
    Worker       *worker = argument;
    WorkerSystem *system = worker->system;
    for (;;) {
        WaitForSingleObject(system->given, INFINITE);
        if (system->ends) {
            return 0;
        }
        worker->task(worker->argument);
        SetEvent(system->done);
        if (worker->on_done != NULL) {
            worker->on_done();
        }
    }
}

static int start(Worker *worker) {
    WorkerSystem *system = worker->system;
    system->given = CreateEventW(NULL, FALSE, FALSE, NULL);
    system->done = CreateEventW(NULL, FALSE, FALSE, NULL);
    if (system->given != NULL && system->done != NULL) {
        system->thread = CreateThread(NULL, 0, work, worker, 0, NULL);
    }
    return system->thread != NULL;
}

static void end(Worker *worker) {
    WorkerSystem *system = worker->system;
    if (system->thread != NULL) {
        system->ends = 1;
        SetEvent(system->given);
        WaitForSingleObject(system->thread, INFINITE);
        CloseHandle(system->thread);
    }
    if (system->given != NULL) {
        CloseHandle(system->given);
    }
    if (system->done != NULL) {
        CloseHandle(system->done);
    }
}

static void give(Worker *worker) { SetEvent(worker->system->given); }

static int is_done(Worker *worker, int wait) {
    return WaitForSingleObject(worker->system->done, wait ? INFINITE : 0) == WAIT_OBJECT_0;
}

#else

#include <pthread.h>

struct WorkerSystem {
    pthread_t       thread;
    pthread_mutex_t lock;
    pthread_cond_t  changed;
    int             given, done, ends; /* under the lock */
    int             runs;
};

static void *work(void *argument) {
    Worker       *worker = argument;
    WorkerSystem *system = worker->system;
    pthread_mutex_lock(&system->lock);
    for (;;) {
        while (!system->given && !system->ends) {
            pthread_cond_wait(&system->changed, &system->lock);
        }
        if (system->ends) {
            break;
        }
        system->given = 0;
        pthread_mutex_unlock(&system->lock);
        worker->task(worker->argument);
        pthread_mutex_lock(&system->lock);
        system->done = 1;
        pthread_cond_broadcast(&system->changed);
        if (worker->on_done != NULL) {
            pthread_mutex_unlock(&system->lock);
            worker->on_done();
            pthread_mutex_lock(&system->lock);
        }
    }
    pthread_mutex_unlock(&system->lock);
    return NULL;
}

static int start(Worker *worker) {
    WorkerSystem *system = worker->system;
    pthread_mutex_init(&system->lock, NULL);
    pthread_cond_init(&system->changed, NULL);
    system->runs = pthread_create(&system->thread, NULL, work, worker) == 0;
    return system->runs;
}

static void end(Worker *worker) {
    WorkerSystem *system = worker->system;
    if (system->runs) {
        pthread_mutex_lock(&system->lock);
        system->ends = 1;
        pthread_cond_broadcast(&system->changed);
        pthread_mutex_unlock(&system->lock);
        pthread_join(system->thread, NULL);
    }
    pthread_cond_destroy(&system->changed);
    pthread_mutex_destroy(&system->lock);
}

static void give(Worker *worker) {
    WorkerSystem *system = worker->system;
    pthread_mutex_lock(&system->lock);
    system->given = 1;
    pthread_cond_broadcast(&system->changed);
    pthread_mutex_unlock(&system->lock);
}

static int is_done(Worker *worker, int wait) {
    WorkerSystem *system = worker->system;
    pthread_mutex_lock(&system->lock);
    while (wait && !system->done) {
        pthread_cond_wait(&system->changed, &system->lock);
    }
    const int done = system->done;
    system->done = 0;
    pthread_mutex_unlock(&system->lock);
    return done;
}

#endif

int worker_start(Worker *worker, void (*on_done)(void)) {
    worker->on_done = on_done;
    worker->system = calloc(1, sizeof *worker->system);
    if (worker->system == NULL || !start(worker)) {
        fprintf(stderr, "cannot start a thread\n");
        worker_end(worker);
        return 0;
    }
    return 1;
}

void worker_begin(Worker *worker, void (*task)(void *), void *argument) {
    worker->task = task;
    worker->argument = argument;
    worker->busy = 1;
    give(worker);
}

int worker_take(Worker *worker, int wait) {
    if (!worker->busy || !is_done(worker, wait)) {
        return 0;
    }
    worker->busy = 0;
    return 1;
}

void worker_end(Worker *worker) {
    if (worker->system != NULL) {
        worker_take(worker, 1);
        end(worker);
        free(worker->system);
        worker->system = NULL;
    }
}
