// The syntax of Power PMAC script: program buffers, and the on-line commands of a load stream.
//
// The rules describe text after the preprocessor. Words are recognised by the class WordLexer (compiler/frontend/power_pmac), which
// cuts glued words such as ta500ts0 or X1.5Y4 and knows the declared names: the lexer below only finds where a word begins.
// A line end is white space. Where lines matter, the pass of token_pass.cpp has told the parser by the tokens: JOIN stands between
// words of one line, LINE_END behind a line that cexec or cskip may leave out or that cx executes, words behind a code letter or call are LINE_WORD, axis words have types of their own (C90 is AXIS, C6 = 1 begins with LETTER_C), and an operator that
// begins a line is no binary one. So every decision but a few of on-line commands is made by one or two tokens.
grammar PowerPmac;

@parser::members {
/// The next token is on the line of the token before it.
bool sameLine() { return _input->LT(1)->getLine() == _input->LT(-1)->getLine(); }
/// What a command takes of its line ends here.
bool restEnds() { return _input->LA(1) == antlr4::Token::EOF || _input->LA(1) == SEMICOLON || !sameLine(); }
/// A pointer's target comes next, on the same line.
bool targetFollows() {
  const size_t type = _input->LA(1);
  return (type == STAR || type == IO_POINTER || type == NAME) && sameLine();
}
/// The name of a local variable comes next, which holds the number of a thing: kill m. Not the left side of an assignment.
bool numberNameFollows() {
  const size_t next = _input->LA(2);
  const bool begins_statement = (next >= ASSIGN && next <= SYNC_DECREMENT) || next == LEFT || next == LEFT_BRACKET || next == DOT || next == ARROW || next == COLON;
  const size_t before = _input->LA(-1);
  const bool is_address = before == HASH || before == COORD || before == AMPERSAND;
  return _input->LA(1) == NAME && sameLine() && !begins_statement && !is_address;
}
/// What list shows comes next on its line.
bool listedFollows() {
  const size_t type = _input->LA(1);
  return (type == PROG || type == PLC || type == SUBPROG || type == FORWARD || type == INVERSE || type == ROTARY || type == NAME) && sameLine();
}
/// The name or number of a buffer comes next, on the same line.
bool bufferNameFollows() { return (_input->LA(1) == NAME || _input->LA(1) == NUMBER) && sameLine(); }
/// An else of that type comes next, or behind one semicolon.
bool elseFollows(size_t type) { return _input->LA(_input->LA(1) == SEMICOLON ? 2 : 1) == type; }
}

tokens {
  // what a WORD can turn out to be
  NAME, MEMBER, SELF_FORMAT, AXIS, VECTOR, RADIUS, NORMAL_VECTOR, PSET_AXIS, CODE, LINE_WORD, LETTER, VAR, JOIN, LINE_END, ELSE_IF, BIT_AND, COORD, LINE_PERCENT, LETTER_C, LETTER_D, LETTER_F, LETTER_I, LETTER_M, LETTER_N, LETTER_R,
  // keywords of both tables
  OPEN, CLOSE, PROG, PLC, SUBPROG, FORWARD, INVERSE, ROTARY, GLOBAL, CSGLOBAL, PTR, LOCAL, SUB,
  ABORT, ADISABLE, BEGIN, CMD, DDISABLE, DISABLE, DKILL, ENABLE, HOLD, HOME, HOMEZ, JOG, JOGRET, KILL, LH, PAUSE, PMATCH, RESUME,
  RUN, SEND, SENDALLCMDS, START, STEP,
  // keywords of buffers
  ABS, BREAK, BSTART, BSTOP, CALL, CALLSUB, CASE, CCALL, CCLR, CCMODE, CCR, CDEF, CEXEC, CIRCLE, CONTINUE, CSET, CSKIP, CUNDEF,
  DEFAULT, DELAY, DO, DREAD, DWELL, ELSE, FRAX, FRAX2, FREAD, GOSUB, GOTO, IF, INC, LINEAR, NOFRAX, NOFRAX2, NORMAL, PCLR, PLOAD,
  PREAD, PSET, PSTORE, PVT, RAPID, READ, RETURN, SPLINE, STOP, SWITCH, TA, TD, TM, TREAD, TS, TSD, TSEL, VREAD, WHILE,
  // keywords of on-line commands; COMMAND is one that takes no argument (r, run, q, hm, ...)
  COMMAND, ON_B, ON_J, ON_OUT, CLEAR, CX, DEFINE, DELETE, LOOKAHEAD, ECHO, LIST, OTHER_COMMAND, ALL
}

// --- a load stream --------------------------------------------------------------------------------------------------------

file : (buffer | online | ';')* EOF ;

buffer : openHeader (entryPoint | statement | ';')* CLOSE ALL* ;

openHeader
  : OPEN (kind=(PROG | PLC | SUBPROG) bufferName parameters? (',' NUMBER)*
         | kind=ROTARY NUMBER?
         | kind=(FORWARD | INVERSE) ('(' NUMBER ')' | NUMBER)?)
  ;

bufferName : NUMBER | NAME ;
parameters : '(' (parameter (',' parameter)*)? ')' ;
parameter : '&'? NAME ;
entryPoint : SUB ':' NAME parameters? ;

// --- statements of a buffer -------------------------------------------------------------------------------------------------

statement
  : block
  | ifStatement
  | whileStatement
  | doStatement
  | switchStatement
  | label
  | declaration
  | motionLine
  | PLAIN_MOVES
  | codeLine
  | assignment
  | callStatement
  | simpleStatement
  | onlineInBuffer
  ;

block : '{' (statement | ';')* '}' ;
body : statement | ';' ;

ifStatement : IF '(' condition ')' body elsePart ;
/// An else belongs to the nearest if. ELSE_IF is an else that an if follows.
elsePart
  : {elseFollows(ELSE_IF)}? ';'? ELSE_IF IF '(' condition ')' body elsePart
  | {elseFollows(ELSE)}? ';'? ELSE body
  | {!elseFollows(ELSE) && !elseFollows(ELSE_IF)}?
  ;
whileStatement : WHILE '(' condition ')' body ;
doStatement : DO body ';'? WHILE '(' condition ')' ;
switchStatement : SWITCH '(' expression ')' '{' (caseLabel | statement | ';')* '}' ;
caseLabel : CASE expression ':' | DEFAULT ':' ;

/// A single = is accepted here so that it can be refused with the remedy.
condition : expression (wrong='=' expression)? ;

label : LETTER_N NUMBER ':' | LETTER_N NUMBER ;

/// What cannot stand in a buffer, accepted to be refused by name.
onlineInBuffer : '#' ({sameLine()}? ~(EOF | ';' | '}' | CLOSE | OPEN))* ;

simpleStatement
  : BREAK
  | CONTINUE
  | RETURN
  | STOP
  | kind=(GOTO | GOSUB | CALLSUB) labelNumber arguments? (JOIN lineWord)*
  | CALL callTarget arguments? (JOIN lineWord)*
  | READ '(' readLetter (',' readLetter)* ')'
  | kind=(DWELL | DELAY) data
  | kind=(CSET | CCLR) data
  | kind=(CEXEC | CSKIP) data (statement | ';')* LINE_END
  | kind=CCALL data? (JOIN lineWord)*
  | CDEF data (JOIN lineWord)*
  | CUNDEF NUMBER?
  | kind=(BSTART | BSTOP)
  | PSET (PSET_AXIS data)+
  | kind=(PCLR | PSTORE | PLOAD | PREAD | VREAD | DREAD | FREAD | TREAD) axisList?
  | programControl
  ;

labelNumber : NUMBER | '(' expression ')' | NAME ;
callTarget : NUMBER | '(' expression ')' | NAME ('.' MEMBER)? ;
arguments : '(' (argument (',' argument)*)? ')' ;
/// &P100, &Table(0): the address of variables, for functions of vectors, matrices and texts.
argument : '&' lvalue | expression ;
readLetter : AXIS | VECTOR | CODE | LETTER | VAR | LETTER_C | LETTER_D | LETTER_F | LETTER_I | LETTER_M | LETTER_N | LETTER_R | NAME ;

// --- motion -------------------------------------------------------------------------------------------------------------------

/// Mode and parameter words, and the move that they begin when it stands on the same line.
motionLine : motionWord (JOIN motionWord)* (JOIN move)? | move ;

motionWord
  : kind=(LINEAR | RAPID)
  | kind=CIRCLE NUMBER
  | kind=(PVT | SPLINE | TSEL | CCR | TA | TD | TS | TSD | TM | LETTER_F) data
  | kind=CCMODE data
  | kind=(ABS | INC | FRAX | FRAX2 | NOFRAX | NOFRAX2) axisList?
  | kind=NORMAL (NORMAL_VECTOR data)+
  ;

/// Words such as P5 behind axis words are for a canned cycle to read.
move : moveWord (JOIN moveWord)* (JOIN lineWord)* ;
moveWord : axisWord | vectorWord | radiusWord ;
axisWord : AXIS data (':' velocity=data)? ('^' trigger=data)? ;
vectorWord : VECTOR data ;
radiusWord : RADIUS data ;
axisList : '(' axisName (',' axisName)* ')' ;
axisName : AXIS | LETTER_C | LETTER_R | VECTOR | LETTER_I | NAME ;

/// G83 X1 Y2 Z-3 R1 Q0.5 M08: code letters call subprograms, which read the words behind them.
codeLine : CODE data (JOIN lineWord)* ;
lineWord : LINE_WORD data (':' velocity=data)? ('^' trigger=data)? ;

/// The argument of a word: a signed constant, or an expression in parentheses. A bare variable is accepted to be refused.
data
  : sign=('+' | '-')? NUMBER
  | '(' expression ')'
  | {sameLine()}? lvalue
  ;

// --- assignments and expressions --------------------------------------------------------------------------------------------

assignment
  : lvalue operation=(ASSIGN | '+=' | '-=' | '*=' | '/=' | '%=' | '&=' | '|=' | '^=' | '>>=' | '<<='
           | SYNC_ASSIGN | '+==' | '-==' | '*==' | '/==' | '&==' | '|==' | '^==') {sameLine()}? expression (',' expression)*
  | lvalue step=('++' | '--' | '++=' | SYNC_DECREMENT)
  ;

/// A function that is called for what it stores: strcpy(&P100, "on").
callStatement : NAME arguments ;

lvalue : variable | reference ;
variable : (VAR | LETTER_C | LETTER_D | LETTER_I | LETTER_M | LETTER_R) (NUMBER | '(' expression ')') ;
reference : NAME suffix* ;
suffix : '[' expression (',' expression)* ']' | '.' MEMBER | arguments ;

expression
  : operation=('-' | '+' | '~' | '!') expression
  | expression operation=('*' | '/' | '%' | BIT_AND) expression
  | expression operation=('<<' | '>>') expression
  | expression operation=('+' | '-' | '|' | '^') expression
  | expression operation=('==' | '!=' | '<>' | '<' | '>' | '<=' | '>=' | '!>' | '!<' | '~' | '!~') expression
  | expression operation='&&' expression
  | expression operation='||' expression
  | '(' expression ')'
  | NUMBER
  | ABS '(' expression ')'
  | variable
  | reference
  | STRING
  ;

// --- declarations --------------------------------------------------------------------------------------------------------------

declaration
  : kind=(GLOBAL | CSGLOBAL | LOCAL) declarator (',' declarator)*
  | PTR pointerDeclarator (',' pointerDeclarator)*
  ;
declarator : NAME ('(' expression ')')? ('=' expression)? ;
pointerDeclarator : NAME ('(' NUMBER ')')? '->' pointerTarget ;
pointerTarget : '*' (SELF_FORMAT NUMBER*)? | IO_POINTER | reference NUMBER* ;

// --- motors, coordinate systems, programs, ports: statements that are on-line commands too ------------------------------------

programControl
  : kind=(ENABLE | DISABLE | PAUSE | RESUME | STEP) PLC plcList
  | kind=(ABORT | ADISABLE | DDISABLE | DISABLE | ENABLE | HOLD | PAUSE | RESUME | RUN | STEP | HOME | HOMEZ | KILL | DKILL) numberList?
  | kind=(BEGIN | START) startItem (',' startItem)*
  | LH direction=('\\' | '<' | '>') numberList?
  | PMATCH
  | JOG jogAction
  | JOGRET numberList? ('=' data)?
  | CMD STRING (',' argument)*
  | SEND NUMBER? ','? STRING (',' argument)*
  | SENDALLCMDS
  ;
startItem : NUMBER ('..' NUMBER)? (':' programName)? | ':' programName | NAME ;
programName : NUMBER | NAME ;
numberList : numberItem (',' numberItem)* ;
numberItem : NUMBER ('..' NUMBER)? | {numberNameFollows()}? NAME | '(' expression ')' | '*' ;
plcList : plcItem (',' plcItem)* ;
plcItem : NUMBER ('..' NUMBER)? | NAME | '(' expression ')' | '*' ;

jogAction
  : operation=('+' | '-' | '/') numberList?
  | numberList? operation=('=' | '==' | ':' | '^') jogDistance ('^' trigger=data)?
  ;
jogDistance : '*' | data ;

// --- on-line commands ------------------------------------------------------------------------------------------------------------

online
  : declaration
  | '#' numberList? ('->' ({sameLine()}? axisDefinition)?)?
  | (COORD | '&') numberList?
  | LETTER_M NUMBER (',' NUMBER)? '->' pointedAt
  | LETTER_I NUMBER '->'
  | variable RANGE NUMBER
  | reference '->' pointedAt
  | assignment
  | onlineListAssignment
  | lvalue
  | CLOSE ALL*
  | DEFINE LOOKAHEAD NUMBER (',' NUMBER)?
  | DELETE LOOKAHEAD
  | kind=(DEFINE | DELETE) ROTARY NUMBER?
  | CLEAR (ALL+ | {sameLine()}? kind=(PROG | PLC | SUBPROG) bufferName)?
  | CX (statement | ';')* LINE_END
  | COMMAND
  | ON_B ({sameLine()}? programName)?
  | ON_J onlineJog
  | ON_OUT data
  | ECHO NUMBER?
  | LINE_PERCENT ({sameLine()}? data)?
  | single=('?' | '\\' | '$' | RESET)
  | LIST ({listedFollows()}? listed | {!listedFollows()}?)
  | OTHER_COMMAND restOfLine
  | programControl
  ;

restOfLine : ({!restEnds()}? ~(EOF | ';'))* {restEnds()}? ;

/// A buffer; or the place of a program (pc, apc), with the number of lines behind a comma.
listed
  : kind=(PROG | PLC | SUBPROG) ({bufferNameFollows()}? bufferName | {!bufferNameFollows()}?)
  | kind=(FORWARD | INVERSE | ROTARY) ('(' NUMBER ')' | NUMBER)?
  | NAME (',' NUMBER?)?
  ;

/// First, count, step: I5213,15,100=10.
onlineListAssignment : variable ',' NUMBER (',' NUMBER)? '=' expression ;

onlineJog : operation=('+' | '-' | '/') | operation=('=' | '==' | ':' | '^') ({sameLine()}? jogDistance ('^' trigger=data)?)? ;

/// What a pointer is made to point at; nothing: the question where it points.
pointedAt : {targetFollows()}? pointerTarget | {!targetFollows()}? ;

axisDefinition
  : LETTER_I
  | CODE NUMBER?
  | axisTerm signedAxisTerm*
  ;
axisTerm : sign=('+' | '-')? axisFactor ;
signedAxisTerm : sign=('+' | '-') axisFactor ;
axisFactor : NUMBER axis=(AXIS | LETTER_C)? | axis=(AXIS | LETTER_C) ;

// --- tokens: the assignment operators stand together, ASSIGN first and SYNC_DECREMENT last -----------------------------------------

SEMICOLON : ';' ;
COLON : ':' ;
LEFT_BRACE : '{' ;
RIGHT_BRACE : '}' ;
LEFT_BRACKET : '[' ;
RIGHT_BRACKET : ']' ;
HASH : '#' ;
AMPERSAND : '&' ;
DOT : '.' ;
ARROW : '->' ;
PLUS : '+' ;
MINUS : '-' ;
STAR : '*' ;
LEFT : '(' ;
RIGHT : ')' ;
COMMA : ',' ;
ASSIGN : '=' ;
ADD_ASSIGN : '+=' ;
SUB_ASSIGN : '-=' ;
MUL_ASSIGN : '*=' ;
DIV_ASSIGN : '/=' ;
MOD_ASSIGN : '%=' ;
AND_ASSIGN : '&=' ;
OR_ASSIGN : '|=' ;
XOR_ASSIGN : '^=' ;
SHR_ASSIGN : '>>=' ;
SHL_ASSIGN : '<<=' ;
SYNC_ASSIGN : '==' ;
SYNC_ADD : '+==' ;
SYNC_SUB : '-==' ;
SYNC_MUL : '*==' ;
SYNC_DIV : '/==' ;
SYNC_AND : '&==' ;
SYNC_OR : '|==' ;
SYNC_XOR : '^==' ;
INCREMENT : '++' ;
DECREMENT : '--' ;
SYNC_INCREMENT : '++=' ;
SYNC_DECREMENT : '--=' ;

// --- tokens ----------------------------------------------------------------------------------------------------------------------

/// u.io:$A0000C.12.1, d.user:8: every dot separates, so the whole form is one token.
IO_POINTER : [usfdiUSFDI] '.' (I O | U S E R) ([:.] (HEX | DIGIT+) ('.' DIGIT+)*)? ;

WORD : [A-Za-z_] [A-Za-z0-9_]* ;
/// The dot of 1..3 is given back by the word lexer: with a predicate here ANTLR's runtime would lose some memory at every number.
NUMBER
  : DIGIT+ ('.' DIGIT*)? EXPONENT?
  | '.' DIGIT+ EXPONENT?
  | HEX
  ;
/// Many plain move lines, which have been read already (plain_moves.h).
PLAIN_MOVES : '\u0001' ;
STRING : '"' (~["\\\r\n] | '\\' ~[\r\n])* '"' ;
RANGE : '..' ;
RESET : '$$$' '***'? ;
SPACE : [ \t\r\n\f]+ -> skip ;
OTHER : . ;

fragment EXPONENT : [eE] [+-]? DIGIT+ ;
fragment HEX : '$' [0-9a-fA-F]+ ;
fragment DIGIT : [0-9] ;
fragment I : [iI] ;
fragment O : [oO] ;
fragment U : [uU] ;
fragment S : [sS] ;
fragment E : [eE] ;
fragment R : [rR] ;
